"""Which layers of charts are taken, and what is drawn in them where it does not say."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.errors import ScenarioError
from radmpc.importing.options import LAYER_ROLES
from radmpc.io.text.files import shown
from radmpc.records import dataclass, field
from radmpc.wording import count_text

__all__ = ["Layers"]

_MOST_NAMED, _MOST_SKIPPED = 8, 5
"""Layers, and features without geometry, that a message lists."""


@dataclass(slots=True, eq=False)
class Layers:
    """Layers asked for, and those met.

    Attributes
    ----------
    requested : mapping
        The role that each gives its features, None where none was asked for; empty takes all.
    met : dict
        Every layer that was met, in the order of the files.
    left_out : int
        Features in none of the layers that are wanted.
    placeless : list of str
        Names of features that are taken and have no geometry.
    """

    requested: dict[str, str | None]
    met: dict[str, None] = field(default_factory=dict)
    left_out: int = 0
    placeless: list[str] = field(default_factory=list)

    @classmethod
    def asked(cls, words: Sequence[str]) -> Layers:
        """Return what is asked for by words like ``shore`` and ``shore=obstacle``.

        Parameters
        ----------
        words : sequence of str
            As in `ImportOptions`.
        """
        wanted: dict[str, str | None] = {}
        for word in words:
            name, _, role = word.rpartition("=")
            is_role = bool(name) and role in LAYER_ROLES
            wanted[name if is_role else word] = role if is_role else None
        return cls(wanted)

    def takes(self, names: Sequence[str]) -> bool:
        """Whether a feature is taken; its layers are noted.

        Parameters
        ----------
        names : sequence of str
            The layers that it lies in, the innermost last.
        """
        self.met.update(dict.fromkeys(names))
        if not self.requested or any(name in self.requested for name in names):
            return True
        self.left_out += 1
        return False

    def role(self, names: Sequence[str]) -> str | None:
        """Return the role that the innermost layer with one gives; None if none does.

        Parameters
        ----------
        names : sequence of str
            The layers that a feature lies in, the innermost last.
        """
        roles = (self.requested.get(name) for name in reversed(names))
        return next((role for role in roles if role is not None), None)

    def check(self) -> None:
        """Refuse a layer that no feature lies in: its obstacles would be missing.

        Raises
        ------
        ScenarioError
            With the layers that there are.
        """
        for name in self.requested:
            if name not in self.met:
                known = [shown(one) for one in self.met]
                more = f" or {len(known) - _MOST_NAMED} more" if len(known) > _MOST_NAMED else ""
                raise ScenarioError(
                    f"must be one of {', '.join(known[:_MOST_NAMED])}{more}, got {shown(name)}",
                    ("layer",),
                )

    def notes(self) -> tuple[tuple[str, str], ...]:
        """Return which are taken, in words; nothing if all are."""
        if not self.requested:
            return ()
        names = [name + (f" as {role}" if role else "") for name, role in self.requested.items()]
        counted = count_text(self.left_out, "feature")
        rest = f"; left out: {counted} of others" if self.left_out else ""
        return (("layers", f"{', '.join(names)}, as asked{rest}"),)

    def warnings(self) -> tuple[str, ...]:
        """Return which features are skipped as they have no geometry; nothing if all have."""
        if not self.placeless:
            return ()
        hidden = len(self.placeless) - _MOST_SKIPPED
        more = f" and {hidden} more" if hidden > 0 else ""
        return (f"without geometry, skipped: {', '.join(self.placeless[:_MOST_SKIPPED])}{more}",)
