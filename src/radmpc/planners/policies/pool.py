"""RADMPC's policy: shares of a common pool of risk (paper, Algorithm 2)."""

from __future__ import annotations

from typing import ClassVar

from radmpc.arguments import check_word
from radmpc.planners.policies.policy import Family, Policy, Solved, SolveRequest
from radmpc.planners.policies.uniform import solve_uniformly, spread_text
from radmpc.program.allocation import Spread
from radmpc.records import dataclass
from radmpc.wording import with_options

__all__ = ["Pool"]


@dataclass(frozen=True, slots=True)
class Pool(Policy):
    """RADMPC's: each subproblem spreads its share of a common pool uniformly.

    Attributes
    ----------
    charge : {'allocated', 'used'}
        What leaves the pool for an executed step: what its rows were allocated (the paper), or
        only the risk they turned out to run.
    spread : {'reached', 'all'}
        Which rows have a share in a subproblem, see `Uniform`.
    """

    family: ClassVar[Family] = "pooled"

    charge: str = "allocated"
    spread: Spread = "reached"

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.charge, ("allocated", "used"), "charge")
        check_word(self.spread, ("reached", "all"), "spread")

    def __str__(self) -> str:
        charge = "" if self.charge == "allocated" else self.charge
        return with_options("pool", charge, spread_text(self.spread))

    @property
    def charges_used(self) -> bool:
        """Whether only the risk that rows run leaves the pool; see `Policy.charges_used`."""
        return self.charge == "used"

    def solve(self, request: SolveRequest) -> Solved:
        """Solve once, the subproblem's share spread evenly; see `Policy.solve`."""
        return solve_uniformly(request, self.spread)
