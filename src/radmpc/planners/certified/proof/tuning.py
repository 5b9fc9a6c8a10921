"""The numbers that the proof was tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How long and how finely the relaxation is searched.

    Attributes
    ----------
    gap : float
        Gap to any certified plan at which the proof is good enough [-], or the gap asked for where
        that is larger: half of what is asked costs four times the nodes.
    reserve : float
        Share of the time limit that the search of a fleet leaves to the proof [-].
    doubtful : float
        Gap from which half-spaces of small fleets are also turned to plans without noise [-]: one
        of three drones (`benchmarks/hunt.py`, seed 21, scene 853) becomes 2.8 % cheaper.
    directions : int
        Directions around every hazard [-]. With 8, 16 and 24 the gap that is left
        is 0.50, 0.35 and 0.27 % on `paper(8)`, 0.52, 0.13 and 0.10 % on `circle(4)`, in 940, 1,400
        and 1,700, and 430, 890 and 1,180 nodes.
    most_together : int
        Vehicles of a set that are searched together from the first; those of larger ones are
        searched alone among many obstacles, and elsewhere in sets of up to as many, together last
        [-]: pairs alone of twenty robots among two hundred boxes took 2 GB and half a minute.
    most_in_pairs : int
        Vehicles of a set up to which sets of fewer are searched among few obstacles [-]: 24 have
        276 pairs, which take a second.
    many_obstacles : int
        Obstacles from which the reach of vehicles is narrowed first to that of plans cheaper than
        the incumbent, and then to that of plans up to one value after the other [-].
    try_nodes : int
        Nodes per vehicle of a set after which it is searched up to a lower value first [-]: most of
        the vehicles of `clutter(4, 100)` are done by then.
    stage : float
        How much further each such value is than what is proven, as a share of what is left [-].
    last_stage : float
        Share of what a set's plan costs beyond the least in empty space, below which what is left
        is searched at once [-]: with 0.1 and a first try of 100 nodes, what was nearly done begins
        anew (`clutter(4, 100, 2)`: 1.97 % left instead of 0.63 %).
    nodes : int
        Nodes per vehicle of a set in the first round, and in all later ones together times
        ``rounds`` [-].
    rounds : int
        Rounds of a set at most, each with twice the nodes of the last [-].
    nodes_of_pairs : int
        Nodes per vehicle of a set up to which its vehicles are searched alone and in pairs before
        it; with twice as many in threes, and so on [-]. With 200 `fleet(16, 20)`, whose sets of
        four are soon done, is left 1.5 % from any certified plan instead of 0.8.
    most_in_space : int
        Vehicles in space that are searched together at all [-]: the cones of 12 drones are 105,000
        rows, and raise the bound of ``swarm(12, 1)`` by 2 %; those of 20 are 350,000, which take
        350 MB, and raised neither that of ``swarm(20, 0)`` nor of LSC's ``empty_20agents_3``.
    least_climbed : int
        Vehicles of a set from which on sets of three and more of them are searched before it [-]:
        with 4, `circle(5)` is left 1.7 % from any certified plan instead of 1.0, and the bound of
        `circle(8)` by sets of five takes 6.0 s instead of 4.0.
    first_growth : float
        What a set of four is expected to gain over what its triples gain [-], before any is
        searched: of `circle(8)` 1.18, of `multi_square8` 1.2; for each more as much again.
    least_weight : float
        Weight up to which a set counts as no part of a packing [-].
    set_gap : float
        Relative gap of the first search of a set [-]: with 0.004 `fleet(256)` takes 6.5 s instead
        of 5.6, and `circle(8)` is 10.74 % from its bound after 1,000 looks at the clock instead of
        10.68; `paper(6..8)` and `circle(4)` take as long.
    finer : float
        By how much it shrinks from one round to the next [-].
    worth : float
        Share of the gap that a set must promise to be searched, at most [-].
    left_out : float
        Share of the gap that the parts that are not searched may promise together [-]: two percent
        of the gap each are twice the gap of ``fleet(1000, 0)``, which was left 1.0 % from any
        certified plan. With 0.02, 0.1 and 0.25 it is left 0.50, 0.51 and 0.59 % after one effort.
    near : float
        Gap of a large fleet from which later efforts may take few nodes more [-].
    last_share : float
        How many, as a share of the first effort's [-]: three efforts more without that took 15 s
        of ``fleet(1000, 1)``, from 0.58 to 0.51 %.
    futile : float
        Share of what is open up to which a search is left open that would not reach the gap even
        in the end [-]: the plan at hand is not the best one, then. 0.3 of the gap asked for
        instead: noise that lasts takes 8.1 times the seconds of white noise instead of 4.2
        (`benchmarks/noise_speed.py`, correlation 0.8).
    most_rows : int
        Rows of relaxations that are kept from one set, and from one round, to the next [-]; others
        are built anew. One robot among two hundred boxes has 30,000: proofs of twenty of them take
        19 MB less than with 200,000; `clutter(4, 100)` and `fleet(256)` take as long.
    slow : float
        Share of what is missing that the nodes left have to promise, by what the latest ones gave,
        of large fleets, from the second effort on [-]: `fleet(1000, 0)` ends at 0.99 % after 28 s
        instead of at 0.98 % after 33. A proof that has no count of nodes is never left for it.
    off : float
        Factor by which the risk of the relaxed plans may miss Δ before another price is tried [-].
    prices : int
        Prices tried at most [-].
    most_step : float
        Factor by which one price differs from the next at most [-].
    same_price : float
        Relative difference up to which a search goes on at its price with a cheaper plan [-].
    least_nodes, least_nodes_each : int
        Nodes that a proof may take in any case [-], and the same per vehicle of those that are
        searched together at most. Nodes of one or two vehicles take 20 to 100 µs: with none of the
        first, a vehicle past two boxes in space is left 13 % from any other plan at steps and 21 %
        along intervals, with 3,000 0.5 and 10 %, and 48 draws of `paper` and `clutter` in the plane
        take as long. With 120, 300 and 500 for each the gap left in the harbor is 6.0, 3.5 and
        3.5 %.
    node_share : float
        Multiple of the nodes of the search for the plan that its proof may take [-]: a node of
        either takes 0.8 to 2 ms on the families of the benchmarks, and a count, unlike a clock,
        gives the same bound on any machine.
    """

    gap: float = 5e-3
    reserve: float = 0.15
    doubtful: float = 0.02
    directions: int = 16
    most_together: int = 8
    most_in_space: int = 12
    most_in_pairs: int = 24
    many_obstacles: int = 12
    try_nodes: int = 300
    stage: float = 0.25
    last_stage: float = 0.3
    nodes: int = 150
    rounds: int = 8
    nodes_of_pairs: int = 600
    least_climbed: int = 6
    first_growth: float = 1.2
    least_weight: float = 1e-9
    set_gap: float = 2e-3
    finer: float = 0.4
    worth: float = 0.02
    left_out: float = 0.05
    near: float = 1e-2
    last_share: float = 0.1
    futile: float = 0.5
    most_rows: int = 60_000
    slow: float = 0.5
    off: float = 1.5
    prices: int = 2
    most_step: float = 2.0
    same_price: float = 0.3
    least_nodes: int = 3000
    least_nodes_each: int = 300
    node_share: float = 2.0


TUNING = Tuning()
"""The values in use."""
