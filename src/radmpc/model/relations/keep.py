"""Ranges that vehicles keep to each other: to stay in radio contact, or in sight."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from radmpc.arguments import field_number, field_parts, field_text, value_text
from radmpc.errors import ScenarioError
from radmpc.ranges import check_size
from radmpc.records import dataclass

__all__ = ["Keep", "check_keep", "checked_keep", "keep_pairs"]


@dataclass(frozen=True, slots=True)
class Keep:
    """Two vehicles whose centers stay within a range of each other; losing it counts as risk.

    Attributes
    ----------
    vehicles : tuple of (str, str)
        Their names.
    within : float
        Largest distance of their centers [m], > 0, at steps and between them as collisions count.

    Examples
    --------
    >>> import radmpc
    >>> radmpc.Keep(["lead", "wing"], 40.0)
    Keep(vehicles=('lead', 'wing'), within=40.0)
    """

    vehicles: tuple[str, str]
    within: float

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(self, vehicles: Sequence[str], within: float) -> None: ...

    def __post_init__(self) -> None:
        """Check the names and the range."""
        names = field_parts(self.vehicles, "a sequence of two names", ("vehicles",))
        for i, name in enumerate(names):
            field_text(name, ("vehicles", i))
        if len(names) != 2 or names[0] == names[1]:
            raise ScenarioError(
                f"must name two vehicles, got {value_text(list(names))}", ("vehicles",)
            )
        object.__setattr__(self, "vehicles", (names[0], names[1]))
        within = field_number(self.within, ("within",))
        if not 0.0 < within < float("inf"):
            raise ScenarioError(f"must be > 0 m, got {within:g}", ("within",))
        check_size(within, ("within",))
        object.__setattr__(self, "within", within)


def checked_keep(given: Iterable[Keep]) -> tuple[Keep, ...]:
    """Return ranges as a tuple.

    Parameters
    ----------
    given : iterable of Keep
        As a caller gives them.

    Raises
    ------
    ScenarioError
        If anything else is among them.
    """
    parts = field_parts(given, "a sequence of Keeps", ("keep",))
    kept = []
    for k, part in enumerate(parts):
        if not isinstance(part, Keep):
            raise ScenarioError(f"must be a Keep, got {value_text(part)}", ("keep", k))
        kept.append(part)
    return tuple(kept)


def check_keep(keep: Sequence[Keep], names: Sequence[str]) -> None:
    """Check that ranges are kept by vehicles that there are, and each pair is named once.

    Parameters
    ----------
    keep : sequence of Keep
        Of a scenario.
    names : sequence of str
        Its vehicles.

    Raises
    ------
    ScenarioError
        With the first that does not.
    """
    known, seen = set(names), set[frozenset[str]]()
    for k, one in enumerate(keep):
        for i, name in enumerate(one.vehicles):
            if name not in known:
                raise ScenarioError(
                    f"must name vehicles of the scenario, got {name!r}", ("keep", k, "vehicles", i)
                )
        pair = frozenset(one.vehicles)
        if pair in seen:
            raise ScenarioError(
                f"repeats the pair {one.vehicles[0]!r} and {one.vehicles[1]!r}",
                ("keep", k, "vehicles"),
            )
        seen.add(pair)


def keep_pairs(keep: Iterable[Keep], names: Sequence[str]) -> tuple[tuple[int, int, float], ...]:
    """Return the indices of each pair that keeps a range, the lower first, and the range [m].

    Parameters
    ----------
    keep : iterable of Keep
        Of a scenario.
    names : sequence of str
        Vehicles; ranges of others are left out.
    """
    places = {name: i for i, name in enumerate(names)}
    found = []
    for one in keep:
        if all(name in places for name in one.vehicles):
            i, j = sorted(places[name] for name in one.vehicles)
            found.append((i, j, one.within))
    return tuple(found)
