"""The numbers that the lattice search was tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How fine the lattice is, and what is searched around its paths.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    displacements_around : int
        Cells by which a displacement may differ from that of the path which is refined [-].
    max_cells : int
        Positions of a coarse lattice at most [-]: its cells grow until it has no more.
    tube : int
        Cells on each side of a path within which the next, finer one is sought [-].
    narrow : float
        Width of gaps up to which their middles get a line of their own [cells].
    reaches : tuple of int
        Cells that the longest displacement covers [-]; more where a coarser lattice has no path.
    near : float
        Share of the unit below which a risk counts as nothing [-].
    nodes : int
        Nodes of a small search around a path or a plan [-].
    nodes_along : int
        Nodes of each of the two searches for the earliest plan [-].
    rough_gap : float
        Relative gap of the second of these [-]: every vehicle is planned anew afterwards.
    earliest_tube : float
        How far the earliest plan may be off its path on the lattice [longest displacements].
    step_share : float
        Share of the risk bound that the earliest plan may risk to gain a step [-].
    """

    displacements_around: int = 3
    max_cells: int = 20_000
    tube: int = 4
    narrow: float = 3.0
    reaches: tuple[int, ...] = (3, 6)
    near: float = 1e-5
    nodes: int = 50
    nodes_along: int = 150
    rough_gap: float = 0.05
    earliest_tube: float = 1.0
    step_share: float = 0.01


TUNING = Tuning()
"""The values in use."""
