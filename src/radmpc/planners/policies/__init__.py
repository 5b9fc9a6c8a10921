"""Risk policies: how Δ becomes margins of rows, and the solves that this takes. One file each.

Each name is loaded when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from radmpc.front import late_names

if TYPE_CHECKING:
    from radmpc.planners.policies.deterministic import NoRisk, Sigmas
    from radmpc.planners.policies.ira import Ira
    from radmpc.planners.policies.optimal import Optimal
    from radmpc.planners.policies.policy import Family, Policy, RiskUse, Solved, SolveRequest
    from radmpc.planners.policies.pool import Pool
    from radmpc.planners.policies.uniform import Uniform

__all__ = [
    "Family",
    "Ira",
    "NoRisk",
    "Optimal",
    "Policy",
    "Pool",
    "RiskUse",
    "Sigmas",
    "SolveRequest",
    "Solved",
    "Uniform",
]

_HOMES = {
    "planners.policies.deterministic": ("NoRisk", "Sigmas"),
    "planners.policies.ira": ("Ira",),
    "planners.policies.optimal": ("Optimal",),
    "planners.policies.policy": ("Family", "Policy", "RiskUse", "SolveRequest", "Solved"),
    "planners.policies.pool": ("Pool",),
    "planners.policies.uniform": ("Uniform",),
}
__getattr__, __dir__ = late_names(__name__, _HOMES)
