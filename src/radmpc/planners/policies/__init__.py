"""Risk policies: how Δ becomes margins of rows, and the solves that this takes. One file each."""

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
