"""The same referee for everyone: controls in, a verdict out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from radmpc.errors import RadmpcError
from radmpc.model.dynamics import rollout
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.referee import certify

__all__ = ["Verdict", "judge", "plan_of"]

Controls = Sequence[npt.ArrayLike]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the referee says about a peer's controls.

    Attributes
    ----------
    cost : float or None
        ``Σ weight · ‖u‖₁``; None where the controls cannot be flown.
    certified : float or None
        Upper bound on the probability of any collision.
    is_within : bool
        Whether that is at most Δ and nothing else is wrong.
    problems : tuple of str
        Limits, goals or shapes that are missed, one sentence each.
    """

    cost: float | None
    certified: float | None
    is_within: bool
    problems: tuple[str, ...]


def plan_of(scenario: Scenario, controls: Controls, author: str) -> Plan:
    """Return the plan that follows from controls.

    Raises
    ------
    RadmpcError
        If an array is ragged, has the wrong shape, or holds numbers that are not finite.
    """
    arrays = [np.asarray(one, dtype=np.float64) for one in controls]
    for array, vehicle in zip(arrays, scenario.vehicles, strict=True):
        wanted = (scenario.horizon, vehicle.system.num_controls)
        if array.shape != wanted or not np.all(np.isfinite(array)):
            raise RadmpcError(f"vehicle {vehicle.name!r}: controls must be finite, {wanted}")
    trajectories = tuple(
        Trajectory(
            name=vehicle.name,
            controls=array,
            means=rollout(vehicle.system, vehicle.start, array),
            covariances=vehicle.covariances(scenario.horizon),
            gain=vehicle.gain,
        )
        for vehicle, array in zip(scenario.vehicles, arrays, strict=True)
    )
    efforts = [
        vehicle.cost_weight * float(np.abs(array).sum())
        for vehicle, array in zip(scenario.vehicles, arrays, strict=True)
    ]
    return Plan(
        scenario=scenario,
        planner=author,
        seed=None,
        status=Status.FEASIBLE,
        cost=float(np.sum(efforts)),
        lower_bound=None,
        risk=Risk(scenario.risk_bound),
        sets=(tuple(vehicle.name for vehicle in scenario.vehicles),),
        trajectories=trajectories,
    )


def judge(scenario: Scenario, controls: Controls, author: str) -> Verdict:
    """Roll controls out and have the plan judged; what cannot be flown is a problem."""
    try:
        plan = plan_of(scenario, controls, author)
    except (RadmpcError, ValueError, TypeError) as error:
        return Verdict(None, None, False, (str(error),))
    certificate = certify(plan)
    return Verdict(plan.cost, certificate.certified, certificate.holds, certificate.problems)
