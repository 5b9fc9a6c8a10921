"""The certified planner: sets planned exactly at one price of risk, joined, and judged."""

from radmpc.planners.certified.planning import plan_certified
from radmpc.planners.certified.verdict import Verdict

__all__ = ["Verdict", "plan_certified"]
