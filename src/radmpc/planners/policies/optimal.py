"""Risk as a variable of the search: what the decomposition ``certified`` plans with."""

from __future__ import annotations

from typing import ClassVar

from radmpc.planners.policies.policy import Family, Policy, Solved, SolveRequest
from radmpc.records import dataclass

__all__ = ["Optimal"]


@dataclass(frozen=True, slots=True)
class Optimal(Policy):
    """Risk allocated together with the faces, at one price for the whole fleet."""

    family: ClassVar[Family] = "priced"

    def __str__(self) -> str:
        return "optimal"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve one program by itself, where there is no common price: with equal risks."""
        from radmpc.planners.policies.uniform import solve_uniformly  # noqa: PLC0415 - `certified` does not ask

        return solve_uniformly(request, "reached")
