"""Plans of fewer steps for vehicles that fly straight legs, and their certificates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError, ScenarioError
from radmpc.model.given import check_plan
from radmpc.model.ledger import bound_text
from radmpc.model.plan import Plan
from radmpc.model.scenario import Workspace
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import steps_visited
from radmpc.records import dataclass, replace
from radmpc.referee.bound.certificate import Certificate, certify
from radmpc.referee.claims.claims import shape_problems
from radmpc.referee.motion import FleetMotion
from radmpc.referee.propagation import propagate

__all__ = ["Thinned", "thin"]

_HALVINGS = 6
"""How often a tolerance is halved that leaves too much risk [-]: down to a sixty-fourth."""

_STRAIGHT = 1e-9
"""Deviation that is rounding [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Thinned:
    """The steps that suffice to follow a plan along straight legs, and what is certified of that.

    Attributes
    ----------
    steps : mapping
        By vehicle, from 0 to the horizon; each leg takes the time between its steps, at one speed.
    deviations : mapping
        By vehicle, how far its legs are from the plan's mean at the same moment, at most [m].
    tolerance : float
        That with which the steps were chosen [m]: the one asked for, or less where that would
        exceed the bound.
    certificate : Certificate
        Of all paths within the deviations: of the same plan with hulls larger by them, and a
        workspace smaller by the largest. Where it does not hold no step is left out.
    """

    steps: Mapping[str, tuple[int, ...]]
    deviations: Mapping[str, float]
    tolerance: float
    certificate: Certificate

    @property
    def note(self) -> str:
        """What an export says of it, in one line."""
        kept = sum(len(steps) for steps in self.steps.values())
        whole = sum(steps[-1] + 1 for steps in self.steps.values())
        told = (
            f"{kept} of {whole} steps are written: straight legs between them stay within "
            f"{max(self.deviations.values()):.3g} m of the plan at the same moment"
        )
        if not self.certificate.holds:
            return f"{told}, NOT certified within the risk bound {self.certificate.bound:g}"
        return f"{told}, with a risk of at most {bound_text(self.certificate.certified)}"


def thin(
    plan: Plan, tolerance: float, *, rounding: float = 0.0, risk_bound: float | None = None
) -> Thinned:
    """Return as few steps as follow a plan within a tolerance and are certified within its bound.

    A vehicle that flies straight legs at even speeds is off the plan's mean, at each moment by a
    vector of some length. Noise and feedback do to it what they do on the plan. So its hull meets
    something only if a hull larger by that length does on the plan, which `certify` bounds.
    The steps of visits and of the arrival stay, so that these are made.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    tolerance : float
        Farthest that a leg of several steps may be from the plan's mean at the same moment [m],
        > 0. It is halved while the certificate exceeds the risk bound. Legs of one step stay,
        however curved the plan is there; their deviation counts in the certificate alike.
    rounding : float
        What writing the steps adds to any deviation [m], >= 0.
    risk_bound : float or None
        What the certificate is to be within, 0 < Δ < 0.5; None is the plan's. A plan that was made
        for less leaves room for deviations.

    Returns
    -------
    Thinned
        All steps, with a certificate that does not hold, where straight legs from step to step
        are too far off already.

    Raises
    ------
    NoPlanError
        If the plan has no trajectories.
    ArgumentError
        If the tolerance is not > 0, or the rounding is below 0.
    ArgumentTypeError
        If an argument is of another kind.
    ScenarioError
        If there is no such risk bound.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> [len(kept) for kept in radmpc.thin(plan, 0.5, risk_bound=0.1).steps]  # of 11 each
    [2, 2]
    """
    check_plan(plan)
    for name, value, least in (("tolerance", tolerance, 0.0), ("rounding", rounding, -1e-300)):
        sign = ">" if name == "tolerance" else ">="
        told = f"{name} must be a number {sign} 0 m, got {value_text(value)}"
        if not is_number(value):
            raise ArgumentTypeError(told)
        if not least < value < np.inf:
            raise ArgumentError(told)
    if not plan.trajectories:
        raise NoPlanError("nothing to thin: the plan has no trajectories")
    if risk_bound is not None:
        scenario = replace(plan.scenario, risk_bound=risk_bound)
        plan = replace(plan, scenario=scenario, risk=replace(plan.risk, bound=risk_bound))
    certificate = certify(plan)
    whole = tuple(range(plan.scenario.horizon + 1))
    every = {trajectory.name: whole for trajectory in plan.trajectories}
    if shape_problems(plan):
        return Thinned(every, dict.fromkeys(every, rounding), tolerance, certificate)
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    if not certificate.holds:
        found = _all_steps(plan, motion, rounding)
        return replace(found, tolerance=tolerance, certificate=certificate)
    for halvings in range(_HALVINGS + 2):
        # The last attempt leaves out what is on a straight leg anyway.
        within = tolerance * 0.5**halvings if halvings <= _HALVINGS else 0.0
        found = _thinned(plan, motion, within, rounding)
        if found.certificate.holds:
            return found
    return replace(_all_steps(plan, motion, rounding), tolerance=0.0)


def _thinned(plan: Plan, motion: FleetMotion, tolerance: float, rounding: float) -> Thinned:
    """Return the fewest steps at a tolerance, and their certificate."""
    steps, deviations = {}, {}
    bulges = _bulges(plan, motion)
    for i, vehicle in enumerate(plan.scenario.vehicles):
        fixed = _fixed(vehicle, motion.states[i])
        steps[vehicle.name] = _fewest(motion.positions[i], bulges[i], fixed, tolerance)
        off = _deviation(motion.positions[i], bulges[i], steps[vehicle.name])
        deviations[vehicle.name] = off + rounding
    return Thinned(steps, deviations, tolerance, _grown_certificate(plan, deviations))


def _all_steps(plan: Plan, motion: FleetMotion, rounding: float) -> Thinned:
    """Return all steps, and the certificate of straight legs between them."""
    whole = tuple(range(plan.scenario.horizon + 1))
    bulges = _bulges(plan, motion)
    deviations = {
        name: float(bulge.max(initial=0.0)) + rounding
        for name, bulge in zip(motion.names, bulges, strict=True)
    }
    steps = dict.fromkeys(motion.names, whole)
    return Thinned(steps, deviations, 0.0, _grown_certificate(plan, deviations))


def _bulges(plan: Plan, motion: FleetMotion) -> Matrix:
    """Return how far the mean curves beside its chord from step to step, (N, T) [m]."""
    lengths = np.linalg.norm(motion.sagittas, axis=2)
    # What counts at the steps alone is not bent between them.
    return lengths if plan.scenario.avoidance == "intervals" else np.zeros_like(lengths)


def _fixed(vehicle: Vehicle, states: Matrix) -> set[int]:
    """Return the steps that stay: both ends, visits, and the arrival."""
    system = vehicle.system
    places = states[:, list(system.position)]
    speeds = None if system.velocity is None else states[:, list(system.velocity)]
    fixed = {0, len(states) - 1, *steps_visited(vehicle.via, places, speeds)}
    arrival = vehicle.goal.arrival(places, speeds)
    return fixed if arrival is None else fixed | {arrival}


def _fewest(
    positions: Matrix, bulges: Vector, fixed: set[int], tolerance: float
) -> tuple[int, ...]:
    """Return the fewest steps whose legs are within a tolerance, by their number from the start.

    A leg is as long as all shorter ones from its first step are within the tolerance, too.
    """
    last = len(positions) - 1
    legs = np.full(last + 1, last + 1)
    before = np.zeros(last + 1, dtype=np.int64)
    legs[0] = 0
    for i in range(last):
        for j in range(i + 1, last + 1):
            is_short = j == i + 1
            if not is_short and _leg(positions, bulges, i, j) > max(tolerance, _STRAIGHT):
                break
            if legs[i] + 1 < legs[j]:
                legs[j], before[j] = legs[i] + 1, i
            if j in fixed:
                break
    kept = [last]
    while kept[-1]:
        kept.append(int(before[kept[-1]]))
    return tuple(reversed(kept))


def _deviation(positions: Matrix, bulges: Vector, kept: Sequence[int]) -> float:
    """Return how far straight legs between some steps are from the plan at most [m]."""
    return max(_leg(positions, bulges, i, j) for i, j in pairwise(kept))


def _leg(positions: Matrix, bulges: Vector, first: int, last: int) -> float:
    """Return how far a leg at one speed is from the plan at the same moment, at most [m].

    Between steps the difference is straight but for what the mean curve deviates from its chord.
    """
    shares = np.linspace(0.0, 1.0, last - first + 1)[:, None]
    line = positions[first] + shares * (positions[last] - positions[first])
    off = np.linalg.norm(positions[first : last + 1] - line, axis=1)
    return float((np.maximum(off[:-1], off[1:]) + bulges[first:last]).max())


def _grown_certificate(plan: Plan, deviations: Mapping[str, float]) -> Certificate:
    """Return the certificate of a plan whose hulls are larger, and whose workspace is smaller."""
    scenario = plan.scenario
    vehicles = tuple(replace(v, radius=v.radius + deviations[v.name]) for v in scenario.vehicles)
    workspace = scenario.workspace
    try:
        if workspace is not None:
            most = max(deviations.values())
            workspace = Workspace(workspace.lower + most, workspace.upper - most)
        grown = replace(scenario, vehicles=vehicles, workspace=workspace)
    except ScenarioError as error:
        return Certificate(
            scenario.risk_bound, 1.0, (), (f"too far off for its scenario: {error}",)
        )
    # What the plan states of itself is of its own hulls.
    risk = replace(plan.risk, certified=None)
    return certify(replace(plan, scenario=grown, risk=risk))
