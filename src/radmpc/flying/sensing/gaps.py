"""What is flown where not all vehicles were measured."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arrays import Vector
from radmpc.flying.knowing import remembers
from radmpc.flying.measuring import States, heard
from radmpc.model.scenario import Scenario

__all__ = ["flown_by", "unmeasured"]


def flown_by(
    scenario: Scenario, expected: Sequence[Vector], states: States
) -> tuple[tuple[Vector, ...], list[str]]:
    """Return by what vehicles fly where not all were measured, and the alarm that says so.

    A vehicle that was measured flies by that, the others by what is expected. So does, measured or
    not, a vehicle whose measurements tell more than its state: the next measurement is compared
    with what the whole gap brought.

    Parameters
    ----------
    scenario : Scenario
        Of the mission.
    expected : sequence of (n,), (2 n + s,) or (3 (2 n + s),) array
        What was expected to be known.
    states : mapping, sequence of (n,) array or None, or None
        What was measured.
    """
    is_scaled = scenario.covariance_samples is not None
    given, known = heard(scenario, states), []
    for vehicle, hoped, state in zip(scenario.vehicles, expected, given, strict=True):
        tells_more = is_scaled or bool(vehicle.shared) or remembers(vehicle)
        known.append(hoped if state is None or tells_more else state)
    names = [v.name for v, state in zip(scenario.vehicles, given, strict=True) if state is None]
    whose = "" if len(names) == len(given) else f" of {', '.join(map(repr, names))}"
    return tuple(known), [f"no measurement{whose}: the tail flies on as expected"]


def unmeasured(scenario: Scenario, states: States) -> str:
    """Return why nothing is decided where not all vehicles were measured.

    Parameters
    ----------
    scenario, states
        As in `flown_by`.
    """
    is_none = all(state is None for state in heard(scenario, states))
    return "nothing was measured" if is_none else "not all vehicles were measured"
