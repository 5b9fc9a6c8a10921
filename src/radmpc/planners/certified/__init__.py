"""The certified planner: sets planned exactly at one price of risk, joined, and judged."""

from radmpc.planners.certified.planning import plan_certified

__all__ = ["plan_certified"]
