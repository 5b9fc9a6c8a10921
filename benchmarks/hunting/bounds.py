"""What a plan's simple bounds sum to: the figure that certified's lower bounds speak of."""

from __future__ import annotations

import math

import numpy as np

from radmpc.gaussian import tail_probability
from radmpc.model.plan import Plan
from radmpc.program.build import build_program, condensed_models

__all__ = ["simple_bounds"]


def simple_bounds(record: Plan) -> float:
    """Return what a plan's simple bounds sum to, by the best side of each avoidance alone.

    At least what the best sides together cost; inf where some avoidance has no side left.
    """
    scenario = record.scenario
    program = build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
    controls = [t.controls.ravel() for t in record.trajectories]
    z = np.concatenate([part for u in controls for part in (u.clip(min=0.0), (-u).clip(min=0.0))])
    chances = tail_probability(program.clearances(z))
    selection = [
        min(sides, key=lambda side: chances[program.rows_of(side)].sum(), default=-1)
        for sides in map(program.alternatives_of, range(program.num_avoidances))
    ]
    if -1 in selection:
        return math.inf
    chosen = np.array(selection, dtype=np.int64)
    return program.initial_risk + float(program.event_risks(z, chosen).sum())
