"""The numbers that the search at a price of risk was tuned with, in one record.

Tolerances of arithmetic and of the linear solver stand where they are used.
"""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """What the search tree looks at first, and when it gives up.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    patience : int
        Nodes after which a dive without any solution gives up for the best bound [-]: fewer raise
        the bound sooner, more find a first plan sooner in narrow scenes.
    headroom : float
        Share of the cutoff by which linear programs run beyond it [-], so that their bounds serve
        at a higher price: for 48 vehicles, 51 of them instead of 589 when the price rises by a
        quarter.
    second_weight : float
        Weight of the second best alternative's violation beside the best's in the choice of the
        avoidance to branch on [-]: where both are large, the bounds of both children rise.
    missing_factor, missing_length : float
        Violation assumed of an alternative that is impossible: so many times the best one's [-],
        and so much more [m]. Avoidances with a single alternative left come early.
    reference : float
        Share of the unit at whose clearance an alternative counts as satisfied when branching [-]:
        larger ones branch on fewer avoidances, and leave more to the exact account of risks.
    tie : float
        Share of the gap within which a node's bound and its point's true value count as equal [-].
    overdrawn : float
        Units of risk that a candidate may run in all [-]: its risks are rescaled to the bound
        afterwards.
    first_tangents : tuple of float
        Clearances of a row's first tangents, beside that at its cap [standard deviations]: optimal
        plans of few vehicles keep near these.
    crowd, crowd_share, crowd_each : int
        Rows beyond which switched-off ones are dropped [-], at least so many times those that a
        program has without chance rows, and how many more per active row: more are idle in every
        pivot, fewer are loaded anew more often. Larger pools were slower.
    rough_gap : float
        Relative gap at which the search for one group of blocks stops [-]: the whole is not optimal
        in any case, and smaller gaps take nodes from other groups.
    nodes_around : int
        Nodes per free block of the search around the plan at hand, before the search proper [-].
    tries : int
        Orders in which blocks are placed [-]; each new one begins with the block that found no
        path.
    greedy_tries : int
        Orders where each block is placed by the construction heuristic [-], whose runs are short.
    nodes : int
        Nodes per free block [-]: it is a heuristic, not a proof.
    open_slack : float
        Difference of slack below which two alternatives are both left to the search [longest
        moves].
    far_slack : float
        Slack from which the best alternative need not be held [longest moves]: the search stays
        near.
    around_gap : float
        Relative gap at which the search around a plan stops [-]: that search is small, and ends by
        its nodes where it is not.
    """

    patience: int = 100
    headroom: float = 0.01
    second_weight: float = 0.5
    missing_factor: float = 2.0
    missing_length: float = 5.0
    reference: float = 0.1
    tie: float = 0.3
    overdrawn: float = 1.2
    first_tangents: tuple[float, ...] = (2.1, 2.6, 3.1)
    crowd: int = 400
    crowd_share: int = 2
    crowd_each: int = 12
    rough_gap: float = 5e-3
    nodes_around: int = 60
    tries: int = 3
    greedy_tries: int = 5
    nodes: int = 200
    open_slack: float = 0.8
    far_slack: float = 1.0
    around_gap: float = 1e-3


TUNING = Tuning()
"""The values in use."""
