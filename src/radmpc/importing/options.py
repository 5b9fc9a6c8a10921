"""Options of an import."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arguments import field_integer, field_number, value_text
from radmpc.errors import ScenarioError
from radmpc.model.scenario import Avoidance
from radmpc.ranges import check_range
from radmpc.records import dataclass

__all__ = ["LAYER_ROLES", "ImportOptions"]

LAYER_ROLES = ("obstacle", "area", "start", "goal", "via", "origin")
"""What a layer of a chart may stand for."""


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What the user has decided; None leaves it to the importer.

    Attributes
    ----------
    dt : float or None
        Step [s].
    horizon : int or None
        Number of steps.
    noise : float or None
        Standard deviation of the position noise added at every step [m].
    risk_bound : float or None
        Joint bound, 0 < Δ < 0.5.
    radius : float or None
        Of every vehicle [m].
    avoidance : {'intervals', 'steps'} or None
        Whether collisions count between steps.
    agents : int or None
        How many of the problem's vehicles are taken, the first ones.
    layer : sequence of str
        Layers of charts that are taken, by name; none takes all. ``"shore=obstacle"`` also says
        what features are that state no role.

    Examples
    --------
    >>> import radmpc
    >>> radmpc.ImportOptions(dt=0.5, risk_bound=0.01).dt
    0.5
    """

    dt: float | None = None
    horizon: int | None = None
    noise: float | None = None
    risk_bound: float | None = None
    radius: float | None = None
    avoidance: str | None = None
    agents: int | None = None
    layer: Sequence[str] = ()

    def __post_init__(self) -> None:
        """Refuse values that no scenario can have."""
        for name, unit in (("dt", "s"), ("noise", "m"), ("radius", "m")):
            value = getattr(self, name)
            if value is not None:
                check_range(value, unit, (name,))
        for name in ("horizon", "agents"):
            if getattr(self, name) is not None:
                field_integer(getattr(self, name), (name,))
        layer = [self.layer] if isinstance(self.layer, str) else self.layer
        if not isinstance(layer, Sequence) or not all(isinstance(n, str) and n for n in layer):
            raise ScenarioError(
                f"must be names of layers, got {value_text(self.layer)}", ("layer",)
            )
        object.__setattr__(self, "layer", tuple(layer))
        if self.horizon is not None and not 1 <= self.horizon <= 1000:
            told = value_text(self.horizon)
            raise ScenarioError(f"must be 1 to 1000 steps, got {told}", ("horizon",))
        if self.agents is not None and self.agents < 1:
            raise ScenarioError(f"must be at least 1 vehicle, got {self.agents}", ("agents",))
        if (
            self.risk_bound is not None
            and not 0.0 < field_number(self.risk_bound, ("risk_bound",)) < 0.5
        ):
            raise ScenarioError(
                f"must lie between 0 and 0.5, both excluded, got {self.risk_bound}",
                ("risk_bound",),
            )
        if self.avoidance is not None and not (
            isinstance(self.avoidance, str) and self.avoidance in {"steps", "intervals"}
        ):
            raise ScenarioError(
                f"must be 'steps' or 'intervals', got {value_text(self.avoidance)}", ("avoidance",)
            )

    @property
    def chosen_avoidance(self) -> Avoidance:
        """Where collisions count: between steps too, unless asked otherwise."""
        return "steps" if self.avoidance == "steps" else "intervals"
