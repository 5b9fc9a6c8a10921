"""What all chunks of samples of a plan share, computed once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.errors import NoPlanError, ScenarioError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee.claims.claims import shape_problems
from radmpc.referee.propagation import propagate
from radmpc.referee.sampling import Sampler
from radmpc.referee.saturation import cutoffs, may_saturate, saturation_bound
from radmpc.referee.simulation.flight import SampledFleet
from radmpc.referee.simulation.projections import projections_of
from radmpc.referee.simulation.sweep import SweepPart, resting, swept
from radmpc.referee.simulation.watch import OBSTACLE, Watch, watch_list

__all__ = ["prepare"]


def prepare(plan: Plan, *, everyone: bool = False) -> SampledFleet:
    """Return a plan ready to be flown.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    everyone : bool
        Whether vehicles are drawn, too, that come near nothing: counts do without them.

    Raises
    ------
    NoPlanError
        If the plan holds no trajectories.
    ScenarioError
        If its vehicles or arrays do not fit its scenario, or overflow.
    """
    problems = shape_problems(plan)
    if problems:
        kind = ScenarioError if plan.trajectories else NoPlanError
        raise kind("; ".join(problems))
    scenario = plan.scenario
    controls = [t.controls for t in plan.trajectories]
    motion = propagate(scenario, controls)
    if motion.problems:
        raise ScenarioError("; ".join(motion.problems))
    saturation = saturation_bound(scenario, motion, controls)
    loose = may_saturate(saturation)
    watched = watch_list(scenario, motion, loose)
    everything = [*watched.usual, *watched.wide]
    involved = [w.first for w in everything] + [w.other[w.are_pairs] for w in everything]
    needed = np.unique(np.concatenate([*involved, np.flatnonzero(loose)]))
    if everyone:
        needed = np.arange(scenario.num_vehicles)
    met = [w.other[w.kinds == OBSTACLE] for w in everything]
    sampler = Sampler.of(motion, needed, np.unique(np.concatenate(met)))
    cut = cutoffs(scenario, motion, loose, controls, sampler)
    projections = projections_of(scenario, motion, sampler, cut[0])
    open_loop = [i for i, v in enumerate(scenario.vehicles) if v.gain is None]
    return SampledFleet(
        scenario,
        motion,
        sampler,
        watched,
        tuple(projections.onto(w) for w in watched.usual),
        tuple(projections.onto(w) for w in watched.wide),
        projections.position_rows,
        projections.bends,
        projections.held_back,
        _solids(scenario, everything),
        cut,
        bool(np.any(saturation[open_loop] > 0.0)),
    )


def _solids(
    scenario: Scenario, watches: Sequence[Watch]
) -> dict[tuple[int, int, int], tuple[SweepPart, ...]]:
    """Return the solids that any row names."""
    num_windows = scenario.horizon + (0 if scenario.avoidance == "intervals" else 1)
    parts: dict[tuple[int, int, int], tuple[SweepPart, ...]] = {}
    for number, watch in enumerate(watches):
        window = number % num_windows
        named = np.flatnonzero(watch.kinds == OBSTACLE)
        keys = np.column_stack([watch.other[named], watch.piece[named]])
        for obstacle_number, piece in np.unique(keys, axis=0).tolist():
            obstacle = scenario.obstacles[obstacle_number]
            key = (obstacle_number, piece, window if obstacle.is_moving else -1)
            if key in parts:
                continue
            here = obstacle.at(window)[piece]
            if obstacle.is_moving and scenario.avoidance == "intervals":
                parts[key] = swept(here, obstacle.at(window + 1)[piece])
            else:
                parts[key] = resting(here)
    return parts
