"""The planning algorithms: the records that a planner is made of, and the named ones.

    from radmpc.planners import Branch, Centralized, Planner, Uniform

A planner is a risk policy, a solver and a decomposition. Each name is loaded when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from radmpc.front import late_names

if TYPE_CHECKING:
    from radmpc.planners.centralized import Centralized
    from radmpc.planners.certified.certified import Certified
    from radmpc.planners.distance import Distance
    from radmpc.planners.paper.algorithm_1_multi_vehicle import Couplings
    from radmpc.planners.paper.algorithm_2_radmpc import Receding
    from radmpc.planners.planner import Decomposition, Planner, Run
    from radmpc.planners.policies import Ira, NoRisk, Optimal, Policy, Pool, Sigmas, Uniform
    from radmpc.planners.presets import PRESETS, Preset, parse_planner
    from radmpc.solvers.branch.branch import Branch
    from radmpc.solvers.milp.big_m import BigM
    from radmpc.solvers.rrt.rrt import Rrt
    from radmpc.solvers.solution import Solver

__all__ = [
    "PRESETS",
    "BigM",
    "Branch",
    "Centralized",
    "Certified",
    "Couplings",
    "Decomposition",
    "Distance",
    "Ira",
    "NoRisk",
    "Optimal",
    "Planner",
    "Policy",
    "Pool",
    "Preset",
    "Receding",
    "Rrt",
    "Run",
    "Sigmas",
    "Solver",
    "Uniform",
    "parse_planner",
]

_HOMES = {
    "planners.centralized": ("Centralized",),
    "planners.certified.certified": ("Certified",),
    "planners.distance": ("Distance",),
    "planners.paper.algorithm_1_multi_vehicle": ("Couplings",),
    "planners.paper.algorithm_2_radmpc": ("Receding",),
    "planners.planner": ("Decomposition", "Planner", "Run"),
    "planners.policies.deterministic": ("NoRisk", "Sigmas"),
    "planners.policies.ira": ("Ira",),
    "planners.policies.optimal": ("Optimal",),
    "planners.policies.policy": ("Policy",),
    "planners.policies.pool": ("Pool",),
    "planners.policies.uniform": ("Uniform",),
    "planners.presets": ("PRESETS", "Preset", "parse_planner"),
    "solvers.branch.branch": ("Branch",),
    "solvers.milp.big_m": ("BigM",),
    "solvers.rrt.rrt": ("Rrt",),
    "solvers.solution": ("Solver",),
}
__getattr__, __dir__ = late_names(__name__, _HOMES)
