"""What a mission decides at one step, and why."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arrays import Vector
from radmpc.flying.account import Account
from radmpc.model.plan import Cause
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass

__all__ = ["Contact", "Entry", "Segment", "Tick", "entered", "failure", "progress_text", "segments"]


@dataclass(frozen=True, slots=True)
class Contact:
    """Something was hit, the workspace left, or a range lost.

    Attributes
    ----------
    step : int
        The mission's step at which it was noticed.
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
    other: str | None = None


def failure(contacts: Sequence[Contact]) -> str:
    """Return in a few words why a mission has failed; empty where nothing was hit or lost.

    Parameters
    ----------
    contacts : sequence of Contact
        Since the account was opened.
    """
    if not contacts:
        return ""
    is_hit = any(contact.cause != "range" for contact in contacts)
    return "something was hit" if is_hit else "a range was lost"


def progress_text(scenario: Scenario, step: int, wealth: float, end: str | None) -> str:
    """Return how far a mission is, and what remains of Δ.

    Parameters
    ----------
    scenario : Scenario
        Of the mission.
    step : int
        At which the next decision is due.
    wealth : float
        Remaining risk: what another leg might risk [-].
    end : str or None
        How the mission ended; None while it is under way.
    """
    where = f"step {step} of {scenario.horizon}" if end is None else end
    return f"{scenario.name!r}: {where}; remaining risk {wealth:.3g} of Δ = {scenario.risk_bound:g}"


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """What one vehicle is to do over one step.

    Attributes
    ----------
    name : str
        The vehicle.
    control : (m,) array
        Held over the step; for a double integrator an acceleration [m/s²].
    position : (d,) array
        Where it begins [m].
    velocity : (d,) array or None
        Its velocity there [m/s]; None where the dynamics have none.
    """

    name: str
    control: Vector
    position: Vector
    velocity: Vector | None


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the mission's account.

    Attributes
    ----------
    step : int
        Of the mission.
    what : str
        "opened", "kept", "adopted", "bound" where Δ was changed, "new grant" where the account
        was opened again.
    risk_bound, tail : float
        As in `Account`, afterwards [-].
    bank : float
        Unallocated risk, afterwards [-].
    wealth : float
        Remaining risk, afterwards: of the tail, and the unallocated risk [-].
    price : float or None
        Risk of the leg that was adopted [-].
    """

    step: int
    what: str
    risk_bound: float
    tail: float
    bank: float
    wealth: float
    price: float | None = None


def entered(step: int, what: str, now: Account, price: float | None) -> Entry:
    """Return a row of the account.

    Parameters
    ----------
    step : int
        Of the mission.
    what : str
        As in `Entry`.
    now : Account
        Afterwards.
    price : float or None
        Risk of the leg that was adopted [-].
    """
    return Entry(step, what, now.risk_bound, now.tail, now.bank, now.wealth, price)


@dataclass(frozen=True, slots=True, eq=False)
class Tick:
    """A decision.

    Attributes
    ----------
    step : int
        Of the mission.
    segments : tuple of Segment
        What to do until the next step; empty at the end.
    choice : {'tail', 'candidate'}
        What is flown.
    reason : str
        Why, in one sentence.
    value : float or None
        Conditional value of the tail before the decision [-]; None where not all were measured.
    wealth : float
        Remaining risk: what another leg might have risked [-].
    price : float or None
        Risk of the candidate, adopted or not [-]; None where there was none.
    next_step : float or None
        What of the value of the leg that is flown is run until the next step [-].
    alarms : tuple of str
        Signs that the model is wrong, one sentence each.
    seconds : float
        What the decision took by the mission's clock [s].
    """

    step: int
    segments: tuple[Segment, ...]
    choice: str
    reason: str
    value: float | None
    wealth: float
    price: float | None
    next_step: float | None
    alarms: tuple[str, ...]
    seconds: float

    @property
    def controls(self) -> tuple[Vector, ...]:
        """The controls of all vehicles, in the scenario's order."""
        return tuple(segment.control for segment in self.segments)


def segments(
    scenario: Scenario, states: Sequence[Vector], controls: Sequence[Vector]
) -> tuple[Segment, ...]:
    """Return what all vehicles are to do.

    Parameters
    ----------
    scenario : Scenario
        Of the mission.
    states : sequence of (n,) array
        Where they are.
    controls : sequence of (m,) array
        What they hold over the step.
    """
    made = []
    for vehicle, state, control in zip(scenario.vehicles, states, controls, strict=True):
        velocity = vehicle.system.velocity
        made.append(
            Segment(
                vehicle.name,
                control,
                state[list(vehicle.system.position)],
                None if velocity is None else state[list(velocity)],
            )
        )
    return tuple(made)
