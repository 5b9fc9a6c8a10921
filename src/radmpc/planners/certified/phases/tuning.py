"""The numbers that the proof around the first plan was tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How long it is tried to do without the search over faces.

    Attributes
    ----------
    nodes : int
        Nodes per vehicle of a set in the first round [-].
    rounds : int
        Rounds at most, with twice the nodes of the last one each [-].
    most_nodes : int
        Nodes of either bound per vehicle, of those that are searched together at most [-].
    nodes_each : int
        The same per vehicle of the fleet, where that is more [-].
    little : float
        Share of the gap by which turning has to make the plan cheaper for another search [-].
    near : float
        Gap to any certified plan up to which the search over faces is not expected to find better
        sides, if the gap asked for is proven [-]: for `fleet(16, 6)`, 1 % open, it found none;
        with 2 % one of `paper(8)` with disturbances that last, 2.9 % open, is 0.09 % cheaper, in
        twice the time.
    same_side : float
        Cosine between the half-spaces of the plan at hand and of the relaxation's above which both
        pass on the same side [-]: with 0.3 `paper(8, 2)` ends 0.14 % dearer.
    apart, most_apart : float
        Share of the gap that risk between sets may cost before they are merged, and share of Δ that
        it may come to [-].
    time_share : float
        Share of the time for the search that this may take [-].
    few_together : int
        Vehicles of a set in each other's way up to which it is searched before the plan at hand is
        turned to the end [-]: sets of four of `circle(8)` take twice as long as that.
    price_share : float
        Price at which the relaxation is searched, over what a little more Δ would save the plan at
        hand [-]: less is charged there. On fourteen draws of `paper(8)`, and of these in
        disturbances of correlation 0.5 and 0.8, plans take 0.99, 0.95 and 0.90 of the time with 1,
        and leave the same gaps; with 0.6 those without take longer.
    left : float
        Share of the gap that the risk which a plan leaves has to be worth for it to be turned once
        more [-].
    efforts : int
        Rounds of the bound on plans by faces after a search, with twice the nodes of the last one
        each, at most [-].
    face_share : float
        Share of the time limit that the search leaves to that bound, where there are obstacles and
        a first plan [-]: with 0.35 `clutter(10, 100, 1)` along intervals is 5 % dearer after 20 s.
    face_share_in_the_open : float
        The same of up to eight vehicles without obstacles [-], whose plans neighborhoods make
        cheaper: within 60 s `multi_square8` comes to 0.9 to 1.3 % by faces with 0.6, to 2.0 with
        0.25.
    least_vehicles, efforts_first, alone_share : int, int, float
        Vehicles from which on every one is searched alone before the search [-]: of four the search
        finds the same sides. Rounds of that, each with twice the nodes of the last, and share of
        the time for the search that these and turning to what they find may take [-]: with 0.3 of
        20 s half of what is gained for `clutter(10, 100)` is not.
    cheaper, turns_alone : float, int
        Share of its effort by which a vehicle has to be cheaper alone to be turned to that [-], and
        how often such are turned to it at most, while that makes the plan cheaper [-].
    ajar, share_in_the_open : float
        Gap by faces after the search from which on neighborhoods of the plan of a few vehicles in
        the open are searched, and share of the time left for improving that this may take [-].
    dear, least_together, share_among_obstacles : float, int, float
        Gap of a first plan to what vehicles cost in empty space, and vehicles in each other's way,
        from which on neighborhoods are searched instead of sets between a few obstacles, and share
        of the time for the search that this may take [-]: with 0.6 `zigzag` within 60 s costs 4.10
        instead of 3.98, and up to 15 % more with other seeds.
    most_led, idle_neighborhoods : int
        Vehicles of a neighborhood at most [-], and neighborhoods in a row without a cheaper plan
        after which no other is searched [-]: of `zigzag` one in ten gains 2 to 10 %, and of
        `multi_square8` 40 end at 27.32 to 27.43, 100 at 27.23 to 27.29. Of up to as many vehicles
        mixed-integer programs of each alone may tell most of the bound, too.
    efforts_alone : int
        Rounds of that bound of every vehicle alone, after which mixed-integer programs are tried
        [-]: of `parking` they have shown by then that they take far longer.
    efforts_for_price : int
        Rounds of that bound after which its price is moved [-].
    price_moves, most_step : int, float
        Times that the price of that bound is moved at most, and the largest factor [-]: that of the
        plan of `clutter(10, 100, 2)` along intervals is a hundredth of the best one.
    most_alternatives : int
        Alternatives of a vehicle among obstacles up to which a mixed-integer program of it is tried
        [-]: those of `parking` have 1,160 and take 7 to 15 s, those of `clutter(10, 100)` 1,800 to
        2,900, and minutes leave more than the search.
    seconds_each : float
        Seconds per alternative that have to be left for such programs to be tried [s]: stopped
        early, those of `parking` prove a ninth of what they prove in the end.
    most_nodes_alone : int
        Nodes of such a program at most [-]: those of `parking` take up to 2,700.
    norm_turns : int
        How often polytopes within limits of norms are turned to the plan at most [-].
    """

    nodes: int = 50
    rounds: int = 5
    most_nodes: int = 400
    nodes_each: int = 60
    little: float = 0.1
    near: float = 0.03
    same_side: float = 0.85
    apart: float = 0.1
    most_apart: float = 0.2
    time_share: float = 0.5
    few_together: int = 3
    price_share: float = 0.85
    left: float = 0.3
    efforts: int = 16
    face_share: float = 0.25
    face_share_in_the_open: float = 0.6
    least_vehicles: int = 6
    efforts_first: int = 2
    alone_share: float = 0.65
    cheaper: float = 0.01
    turns_alone: int = 2
    ajar: float = 0.02
    share_in_the_open: float = 0.5
    share_among_obstacles: float = 0.95
    dear: float = 0.3
    least_together: int = 3
    most_led: int = 3
    idle_neighborhoods: int = 100
    efforts_alone: int = 5
    efforts_for_price: int = 2
    price_moves: int = 6
    most_step: float = 10.0
    most_alternatives: int = 1500
    seconds_each: float = 0.008
    most_nodes_alone: int = 20000
    norm_turns: int = 4


TUNING = Tuning()
"""The values in use."""
