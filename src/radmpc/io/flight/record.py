"""A flight as values: the plan, how it was flown, and a row for every tick."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import groupby

from radmpc.arguments import check_integer, is_number, value_text
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ArgumentError
from radmpc.model.plan import Cause, Plan
from radmpc.records import dataclass, field
from radmpc.wording import count_text

__all__ = [
    "FlightRecord",
    "FlightSettings",
    "FlownMission",
    "NewLeg",
    "ScaleRow",
    "TickRow",
    "Touch",
]


@dataclass(frozen=True, slots=True)
class FlightSettings:
    """How a plan is flown.

    Attributes
    ----------
    backend : str
        What it is flown with, by name.
    replan : str or None
        Preset that plans anew; None flies the plan as it is.
    missions : int
        How many times.
    seed : int
        Of the noise of all missions and of every plan.
    deadline : float or None
        Seconds for a decision; None is no limit [s].
    options : mapping of str to str
        What else the backend takes.
    """

    backend: str = "model"
    replan: str | None = "certified"
    missions: int = 1
    seed: int = 0
    deadline: float | None = None
    options: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse numbers out of their ranges."""
        check_integer(self.missions, "missions", 1)
        check_integer(self.seed, "seed", 0)
        value = self.deadline
        if value is not None and not (is_number(value) and 0.0 <= value < math.inf):
            raise ArgumentError(f"deadline must be seconds >= 0 or None, got {value_text(value)}")


@dataclass(frozen=True, slots=True)
class Touch:
    """Something was hit, the workspace left, or a range lost.

    Attributes
    ----------
    step : int
        At which it was noticed.
    cause : {'pair', 'obstacle', 'workspace', 'range'}
        What was hit, left or lost.
    vehicle : str
        The vehicle.
    other : str or None
        The other vehicle or the obstacle; None for the workspace.
    """

    step: int
    cause: Cause
    vehicle: str
    other: str | None


@dataclass(frozen=True, slots=True)
class ScaleRow:
    """What is known of the factor by which stated covariances are to be multiplied.

    Attributes
    ----------
    samples : int
        Degrees of freedom: the independent steps covariances were estimated from, and all that was
        measured since.
    factor : float
        Times the stated covariances, those that follow from both [-].
    """

    samples: int
    factor: float


@dataclass(frozen=True, slots=True, eq=False)
class NewLeg:
    """A leg that was adopted; means, covariances and rows follow from it.

    Attributes
    ----------
    risk_bound : float
        What it was allowed to risk [-].
    starts : tuple of (n,) array
        Where its nominal begins.
    controls : tuple of (T − k, m) array
        Its nominal controls.
    means : tuple of (T − k + 1, n) array, or None
        Its nominal, where that does not follow from starts and controls alone: what was known of
        disturbances that last, or are shared, adds to it.
    """

    risk_bound: float
    starts: tuple[Vector, ...]
    controls: tuple[Matrix, ...]
    means: tuple[Matrix, ...] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TickRow:
    """One tick of one mission: what was measured, decided and charged.

    Attributes
    ----------
    mission, step : int
        Which tick.
    states : tuple of (n,) array, or None
        Measured; None where not all were.
    contacts : tuple of Touch
        What was hit since the tick before.
    choice, reason : str
        'tail' or 'candidate', and why.
    value, price, next_step : float or None
        As in `radmpc.Tick` [-].
    wealth : float
        Remaining risk: what another leg might have risked [-].
    tail, bank : float
        Risk of the leg in the air, and unallocated risk, after the decision [-].
    controls : tuple of (m,) array
        What is flown until the next step; empty at the end.
    excess : float
        By how much feedback asked for more control than there is [of the control's unit].
    leg : NewLeg or None
        The leg that was adopted, if one was.
    alarms : tuple of str
        Signs that the model is wrong.
    seconds : float
        What the decision took [s].
    scale : ScaleRow or None
        What is known by then of the factor of covariances; None where they are known.
    partly : tuple of (n,) array or None, or None
        Measured where some vehicles were and others not, of which it is None; None elsewhere.
    """

    mission: int
    step: int
    states: tuple[Vector, ...] | None
    contacts: tuple[Touch, ...]
    choice: str
    reason: str
    value: float | None
    wealth: float
    price: float | None
    next_step: float | None
    tail: float
    bank: float
    controls: tuple[Vector, ...]
    excess: float
    leg: NewLeg | None
    alarms: tuple[str, ...]
    seconds: float
    scale: ScaleRow | None = None
    partly: tuple[Vector | None, ...] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class FlownMission:
    """The rows of one mission.

    Attributes
    ----------
    number : int
        From 0.
    rows : tuple of TickRow
        In order.
    horizon : int
        Steps of the whole mission.
    """

    number: int
    rows: tuple[TickRow, ...]
    horizon: int

    @property
    def is_over(self) -> bool:
        """Whether it was flown to its end."""
        return bool(self.rows) and self.rows[-1].step == self.horizon

    @property
    def contacts(self) -> tuple[Touch, ...]:
        """What was hit."""
        return tuple(touch for row in self.rows for touch in row.contacts)

    def __repr__(self) -> str:
        """Return what became of it in one line."""
        hit = count_text(len(self.contacts), "contact") if self.contacts else "no collision"
        return f"FlownMission({self.number}: {count_text(len(self.rows), 'tick')}, {hit})"


@dataclass(frozen=True, slots=True, eq=False)
class FlightRecord:
    """All that a flight file holds.

    Attributes
    ----------
    plan : Plan
        What was flown first, in every mission.
    settings : FlightSettings
        How.
    rows : tuple of TickRow
        Mission after mission.
    changed : tuple of int
        Lines of the file that are not as they were written, from 1.
    versions : mapping of str to str
        Of the packages that flew.
    """

    plan: Plan
    settings: FlightSettings
    rows: tuple[TickRow, ...] = ()
    changed: tuple[int, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)

    @property
    def doubts(self) -> str:
        """What is wrong with the file's lines, in a clause; empty where nothing is."""
        if not self.changed:
            return ""
        more = len(self.changed) - 1
        others = f" and {more} more are" if more else " is"
        return f"line {self.changed[0]}{others} not as {'they were' if more else 'it was'} written"

    @property
    def missions(self) -> tuple[FlownMission, ...]:
        """The missions, the last of which may not be over."""
        horizon = self.plan.scenario.horizon
        return tuple(
            FlownMission(number, tuple(rows), horizon)
            for number, rows in groupby(self.rows, key=lambda row: row.mission)
        )

    def __repr__(self) -> str:
        """Return the flight in one line."""
        over, asked = sum(mission.is_over for mission in self.missions), self.settings.missions
        name = self.plan.scenario.name
        ticks = count_text(len(self.rows), "tick")
        return f"FlightRecord({name!r}: {over} of {asked} missions over, {ticks})"
