"""A study of a few seconds."""

from __future__ import annotations

from dataclasses import replace

from radmpc.experiments.study import (
    Method,
    Study,
)
from radmpc.planners.presets import PRESETS
from radmpc.solvers.branch.branch import Branch


def small(seeds=2, samples=2_000, **changes):
    methods = (
        Method("ira", replace(PRESETS["ira"].planner, solver=Branch()), seeds, role="reference"),
        Method("multi-vehicle", PRESETS["multi-vehicle"].planner, seeds),
        Method("certified", PRESETS["certified"].planner, seeds),
    )
    return Study((2, 3), methods, samples, 20.0, **{"shown": {2: 0}, **changes})


def smallest(seeds=1, **changes):
    """Return the study of one method, for what its rows hold does not matter to."""
    return small(seeds, **changes).only(["certified"])
