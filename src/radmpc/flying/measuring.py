"""What is measured, checked before anything is decided by it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arguments import check_executor, check_integer, is_number, value_text
from radmpc.arrays import Frozen, Vector, as_vector, field_names
from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError, ScenarioError
from radmpc.flying.tick import Contact
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.ranges import LARGEST
from radmpc.referee.claims.claims import shape_problems
from radmpc.result import Result

__all__ = [
    "are_known_alike",
    "check_contacts",
    "check_continues",
    "check_number",
    "check_options",
    "heard",
    "measured",
    "plan_of",
]

States = Mapping[str, npt.ArrayLike | None] | Sequence[npt.ArrayLike | None] | None
"""Measured states, by vehicle or in the scenario's order; None is no measurement."""

_KNOWN = (
    *("start", "initial_covariance", "disturbance_covariance", "disturbance_correlation"),
    *("measurement", "shared", "belief"),
)
"""What says how well a vehicle is known."""


def plan_of(result: Result | Plan) -> Plan:
    """Return the plan of a result, or the plan itself.

    Parameters
    ----------
    result : Result or Plan
        What is to be flown.

    Raises
    ------
    ArgumentTypeError
        If it is neither.
    NoPlanError
        If the result holds no plan.
    ScenarioError
        If its vehicles or arrays do not fit its scenario.
    """
    plan = result.require() if isinstance(result, Result) else result
    check_plan(plan, "result")
    if not plan.trajectories:
        raise NoPlanError(plan.explanation or plan.status_sentence)
    problems = shape_problems(plan)
    if problems:
        raise ScenarioError("; ".join(problems))
    return plan


def check_continues(plan: Plan, scenario: Scenario, left: int) -> None:
    """Refuse a plan that is none of the steps that are left of a mission.

    Parameters
    ----------
    plan : Plan
        The plan.
    scenario : Scenario
        Of the mission.
    left : int
        Steps that are left of it.

    Raises
    ------
    ScenarioError
        If it is of another number of steps, or of other vehicles.
    """
    names, given = ([v.name for v in each.vehicles] for each in (scenario, plan.scenario))
    if plan.scenario.horizon != left or given != names:
        raise ScenarioError(
            f"must be a plan of {left} steps of {names}, got {plan.scenario.horizon} steps of "
            f"{given}",
            ("scenario",),
        )


def measured(scenario: Scenario, states: States) -> tuple[Vector, ...] | None:
    """Return measured states in the scenario's order, None where they are no measurement.

    Parameters
    ----------
    scenario : Scenario
        Of the mission.
    states : mapping, sequence of (n,) array or None, or None
        By vehicle, or in the scenario's order; if any is None, not finite or beyond what
        scenarios take, there is none.

    Raises
    ------
    ArgumentTypeError
        If they are of another kind.
    ScenarioError
        If they are not of the scenario's vehicles.
    """
    found = heard(scenario, states)
    whole = tuple(state for state in found if state is not None)
    return whole if len(whole) == len(found) else None


def heard(scenario: Scenario, states: States) -> tuple[Vector | None, ...]:
    """Return measured states in the scenario's order, None of each vehicle that has none.

    Parameters
    ----------
    scenario, states
        As in `measured`, and refused alike.
    """
    vehicles = scenario.vehicles
    if states is None:
        return (None,) * len(vehicles)
    is_listed = isinstance(states, Mapping | Sequence) or np.ndim(states) > 0
    if isinstance(states, str) or not is_listed:
        raise ArgumentTypeError(f"states must be a sequence of states, got {value_text(states)}")
    if isinstance(states, Mapping):
        missing = [v.name for v in vehicles if v.name not in states]
        if missing:
            raise ScenarioError(f"must have a state of every vehicle, lacks {missing}", ("states",))
        if len(states) > len(vehicles):
            known = [v.name for v in vehicles]
            unknown = [name for name in states if name not in known]
            raise ScenarioError(f"must be of the vehicles {known}, got {unknown}", ("states",))
        states = [states[v.name] for v in vehicles]
    if len(states) != len(vehicles):
        raise ScenarioError(f"must be {len(vehicles)} states, got {len(states)}", ("states",))
    found: list[Vector | None] = [None] * len(vehicles)
    for i, (state, vehicle) in enumerate(zip(states, vehicles, strict=True)):
        if state is not None and np.all(np.abs(_numbers(state, i)) <= LARGEST):
            found[i] = as_vector(state, vehicle.system.num_states, ("states", i))
    return tuple(found)


def _numbers(state: npt.ArrayLike, place: int) -> Vector:
    """Return a state as real numbers, finite or not; refuse what is none."""
    try:
        given = np.asarray(state)
    except ValueError:  # of rows as long as none other
        given = np.zeros(0, dtype=object)
    if given.dtype.kind not in "fiu":
        raise ScenarioError(
            f"must be a vector of numbers, got {value_text(state)}", ("states", place)
        )
    return given.astype(np.float64)


def check_contacts(contacts: object) -> None:
    """Refuse what are no contacts.

    Parameters
    ----------
    contacts : sequence of Contact
        What was hit.

    Raises
    ------
    ArgumentTypeError
        If they are anything else.
    """
    if not isinstance(contacts, list | tuple) or any(
        not isinstance(one, Contact) for one in contacts
    ):
        raise ArgumentTypeError(
            f"contacts must be a list or tuple of Contact, got {value_text(contacts)}"
        )


def check_options(seed: object, executor: object, warm: object) -> None:
    """Refuse options of a mission that are of another kind, or a negative seed.

    Parameters
    ----------
    seed : int
        Of every plan, at least 0.
    executor : Executor or None
        Where plans are made.
    warm : bool or None
        Whether quick candidates are made.

    Raises
    ------
    ArgumentTypeError
        If one is of another kind.
    ArgumentError
        If the seed is negative.
    """
    check_integer(seed, "seed", 0)
    check_executor(executor)
    if warm is not None and not isinstance(warm, bool):
        raise ArgumentTypeError(f"warm must be True, False or None, got {value_text(warm)}")


def check_number(value: object, name: str, most: float = float("inf")) -> None:
    """Refuse what is no number at least 0 and at most something.

    Parameters
    ----------
    value : object
        The argument.
    name : str
        What it is called.
    most : float
        Largest value allowed.

    Raises
    ------
    ArgumentTypeError
        If it is no number.
    ArgumentError
        If it is out of the range.
    """
    if not is_number(value):
        raise ArgumentTypeError(f"{name} must be a number, got {value_text(value)}")
    if not 0.0 <= value <= most:
        allowed = "at least 0" if most == float("inf") else f"from 0 to {most:g}"
        raise ArgumentError(f"{name} must be {allowed}, got {value:.6g}")


def are_known_alike(scenario: Scenario, other: Scenario) -> bool:
    """Whether the same is known of a fleet in two scenarios, and its noise is the same.

    Parameters
    ----------
    scenario, other : Scenario
        Of the same vehicles.
    """
    pairs = zip(scenario.vehicles, other.vehicles, strict=True)
    return scenario.covariance_samples == other.covariance_samples and all(
        _are_alike(getattr(one, name), getattr(two, name)) for one, two in pairs for name in _KNOWN
    )


def _are_alike(one: object, other: object) -> bool:
    """Whether two values are the same to the last digit."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_are_alike, one, other))
    if isinstance(one, Frozen) and type(one) is type(other):
        names = field_names(type(one))
        return all(_are_alike(getattr(one, name), getattr(other, name)) for name in names)
    return bool(np.array_equal(one, other))  # type: ignore[arg-type] # None, numbers, arrays
