"""The numbers that paths through narrow passages were tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How fine grids are, what clearance paths on them have, and how much is tried.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    alone_sweeps : int
        Sweeps before vehicles in the way of others are planned again, too [-].
    further : float
        How far around its places one looks, once a vehicle came near what was not seen there, in
        multiples of how far it strayed [-].
    negligible : float
        What a half-space may be missed by [m].
    mended : int
        Vehicles of a large fleet that miss anything up to which other paces are drawn for each [-].
    paces : int
        Such paces for each at most [-]: one of nine maps of 40 to 60 robots has its first plan
        after 15 s instead of none within 40, the others after 0.1 to 2.6 s more, one after 6 less.
    strengths : tuple of float
        How much sooner or later they are, one after the other [steps].
    mending_rounds, mending_penalty : int, float
        Times that a vehicle is planned along one at most [-], and the first penalty of a meter
        missed, see `Tuning.first_penalty` of `turned` [-].
    joint_count : int
        Vehicles that are planned together at most, one that misses room and those in its way [-].
    joint_rounds : int
        Times that they are, at most [-].
    joint_price : float
        What they pay for risk, in multiples of the price that all begin with [-].
    joint_enough : float
        Share of the hopeful risk, see `Tuning.hopeful` of `turned`, at which theirs is small [-].
    joint_stays : float
        Share of the risk of the round before above which it stays [-].
    grid_points : int
        Points of the grid along its longest axis [-].
    straight_points : int
        Points of a path that a straight piece may replace at most [-].
    sampled : float
        Distance of the places that a straight piece is sampled at [spacings].
    lost_clearance : float
        Loss of clearance for which a straight piece still replaces points of a path [m].
    corner_sigmas : float
        Standard deviations from an obstacle that are worth a corner [-].
    beside : float
        How far paths are sought beside those on a coarser grid [radii of the largest].
    pace_orders : int
        Orders in which vehicles are paced, at most [-].
    hurry : float
        What a step before the goal costs where no order at least effort leads to places for all, in
        multiples of what reaching full speed costs [-].
    finenesses : tuple of float
        Places on the paths of those that find no controls for their pace, in multiples of the
        usual number [-]: where corners fall between places, others may be on them.
    mends : int
        Times that every vehicle is placed again around all others [-].
    grid_pace : float
        Share of what a vehicle covers in a step at most that it may on the grid [-]: it has to
        speed up and slow down. All of it where no order leads to places for all.
    order_sigmas : tuple of float
        Standard deviations kept from obstacles, and from vehicles placed before, where vehicles
        are planned in an order [-].
    wait_cost : float
        Cost of a tick at rest, as a share of a move to the next point [-]: cheap, but not free.
    grid_orders : int
        Orders that are tried on the grid, at most [-].
    grid_work : float
        Points times ticks times vehicles beyond which nothing is tried [-]: 4e7 take some 5 s.
    joint_sigmas : tuple of float
        Standard deviations kept from obstacles, and from each other, where vehicles move
        together [-].
    lattice_growth : float
        Steps in which the spacing of the lattice grows while one is sought on which starts and
        goals lie [multiples of the least].
    lattice_widest : float
        Largest spacing of the lattice [multiples of the least].
    lattice_off : float
        How far starts and goals may lie from nodes to count as on them [spacings].
    lattice_nodes : int
        Nodes beyond which nothing is tried [-].
    joint_draws : int
        Solutions that are drawn [-]: each takes 5 ms for 12 vehicles on 52 nodes, and the best of
        40 has some 20 % fewer ticks.
    soon : int
        Configurations that each draw looks at, at most, as long as any has a solution [-]. Of 12 to
        15 vehicles on 52 nodes half of the draws have one by then, and hardly any that comes later
        is shorter; the shortest has a third of the longest's ticks.
    soon_draws : int
        Draws of which none has a solution by then, after which more configurations are looked at
        [-]: 40 such draws take 100 robots 3 s.
    long_draws : int
        Draws of more configurations, once one has a solution [-]: 0.6 s each for 100 robots.
    few : int
        Vehicles up to which several of the best are routed anew [-]: 12 take 20 ms each.
    rerouted : int
        How many of the best are, then [-].
    reroutes : int
        Groups that are routed anew in each, per vehicle, at most [-]: 1 to 5 ms each, and 9 to 12
        per vehicle are enough on 32 x 32 cells.
    configurations : int
        Configurations that are looked at, at most [-]: 12 vehicles take 0.3 ms each.
    """

    alone_sweeps: int = 2
    further: float = 1.5
    negligible: float = 1e-7
    mended: int = 8
    paces: int = 12
    strengths: tuple[float, ...] = (0.3, 0.6, 1.0, 1.5, 2.5)
    mending_rounds: int = 4
    mending_penalty: float = 660.0
    joint_count: int = 8
    joint_rounds: int = 6
    joint_price: float = 20.0
    joint_enough: float = 0.03
    joint_stays: float = 0.95
    grid_points: int = 160
    straight_points: int = 24
    sampled: float = 0.5
    lost_clearance: float = 1e-3
    corner_sigmas: float = 6.0
    beside: float = 2.8
    pace_orders: int = 16
    hurry: float = 1.0
    finenesses: tuple[float, ...] = (0.75, 1.25, 1.5)
    mends: int = 2
    grid_pace: float = 0.8
    order_sigmas: tuple[float, float] = (1.0, 2.0)
    wait_cost: float = 0.05
    grid_orders: int = 12
    grid_work: float = 4e7
    joint_sigmas: tuple[float, float] = (1.0, 1.0)
    lattice_growth: float = 0.02
    lattice_widest: float = 2.5
    lattice_off: float = 0.12
    lattice_nodes: int = 4000
    joint_draws: int = 40
    soon: int = 300
    soon_draws: int = 10
    long_draws: int = 4
    few: int = 24
    rerouted: int = 4
    reroutes: int = 40
    configurations: int = 3000


TUNING = Tuning()
"""The values in use."""
