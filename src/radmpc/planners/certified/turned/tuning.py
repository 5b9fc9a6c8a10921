"""The numbers that turning half-spaces was tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How long half-spaces are turned, and at which price.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    rounds : int
        Turns at most [-], twice as many from a plan that risks too much. The benchmarks' families
        take 5 to 20 and mostly stop when little is gained; the first few often exceed Δ and are
        lost.
    most_solves, least_rounds : int
        Solves of groups after which no round is begun [-], but for so many rounds of all: large
        fleets gain little by the solve, and a count, unlike a clock, gives the same plan on any
        machine.
    most_work : float
        The same for pivots times rows and columns of their programs [-]; 4e8 take some 7 s.
    work_each : float
        What they may take per vehicle where that is more [-]: `fleet(256)` ends by itself after 7
        rounds and 2e8.
    most_together : int
        Vehicles up to which the whole fleet shares one linear program [-]. One of 20 vehicles in
        space takes 30 ms, by sets of their own the same plans are 0.1 % dearer.
    most_before_plan, each_before_plan : int
        Vehicles up to which a set shares a linear program while there is no plan between obstacles,
        and how many of a larger one share one then, one after the other [-]. Twenty robots on 8 x 8
        cells take 2 to 3 s a round together (34,000 columns) and 0.4 s by fives. Their first plan
        comes after 5 s instead of 12, 13 % dearer until the next round.
    side_by_side : int
        Vehicles of small sets that share one in larger fleets [-]: on `fleet(64)` a round takes
        0.21, 0.11, 0.09, 0.07 and 0.06 s with sets one by one, and up to 4, 8, 16 and 32 vehicles.
    spacing, finer, least_spacing : float
        Between clearances at which risk is interpolated around the latest: at first, its factor
        from round to round, and at least [standard deviations]. At 0.12 `empty_20agents_3` is
        0.03 % dearer.
    ahead : float
        Share of the last move by which half-spaces are turned ahead of the latest paths [-]:
        without it the last per mille takes twice as many rounds on `paper(8)`, from 2 on paths
        swing.
    crossed : float
        Clearance of the latest path below which a half-space is not turned ahead of it [standard
        deviations]: it might be that of another side.
    first_penalty, penalty_growth, last_penalty : float
        Penalty for a meter missed, in multiples of what the cheapest meter of detour costs: in the
        first sweep, its factor from sweep to sweep, and at most [-]. Small at first, so that
        several vehicles share a detour instead of the first one making all of it.
    paced_penalty : float
        The first of these where vehicles are placed at a pace that keeps them clear of each other
        [-]: with a small one they leave it, and miss more in the end.
    paced_sweeps : int
        Sweeps over those of them that miss anything, at most [-]; most attempts take two to six.
    misses : float
        What a vehicle misses in all for another pace to be sought for it [mean radii].
    steady : float
        Relative change of the cost below which sweeps without a miss end [-].
    stuck : int
        Sweeps in which what is missed falls by less than a tenth, after which nothing is expected
        [-].
    stuck_at : float
        Share of what a vehicle missed before from which on planning it again is given up [-].
    looks : int
        Times that a group is planned in a round at most [-], until its paths stay where half-spaces
        were.
    further : float
        Factor on how far one looks around for it [-].
    max_sweeps : int
        Sweeps over the fleet for a first plan, at most [-]; `empty_40agents_3` takes nine.
    quick_sweeps, few_sweeps : int
        The same where there are other routes to begin with [-]; among obstacles, where these stop
        few: `clutter(10, 100, 1)` along intervals begins at 25.5 by 16 to 28 sweeps, at 28.2 by 12.
    telling, sooner : int, float
        Number of the sweep from which on such an attempt is left if it misses as much as leads to
        nothing, and the factor on that from each sweep to the one before [-]. Of twelve maps with 8
        to 40 robots all that did after four sweeps still missed half of it after twelve; of 50
        attempts on maps and among boxes those that led to something missed at most 6.1, 3.7, 1.6
        and 0.6 times as much after one to four. Of 60 robots a sweep takes half a second.
    short, short_along : float
        Time for the search below which a plan is made before it in large fleets, per vehicle, at
        steps and along intervals [s]. The first certified plan of `fleet(256)` to `(1000)` takes 6
        to 9 ms per vehicle without one at steps, and 10 to 14 with; along intervals 14 to 48
        without, and 12 to 34 with, or there is none.
    short_by_highs : float
        The same without compiled code [s]: the first round of `fleet(64)` takes 60 ms per vehicle.
    attempts : int
        Times of routes around obstacles that a first plan is tried with, at most [-]: each takes
        0.1 to 0.5 s for three to eight vehicles.
    joint_attempts : int
        Times that everyone is moved together tick by tick, drawn anew, until that leads to a plan
        [-]: one robot of twenty that is stopped in one of them is not in the next.
    arches : tuple of float
        How far everyone keeps to the right of its straight route in other beginnings than that one
        [largest radii]: `circle(16)` begins at 89.7 by the first, at 96.6 without.
    most_arc : float
        How far routes lead past the straight one at most, when sides are drawn [largest radii].
    narrower : float
        Share of the clearance kept where routes are too narrow for all of it [-].
    nearly : float
        What paths may miss in all to be turned at a price of risk all the same [mean radii].
    nearly_each : float
        The same of large fleets, for each vehicle [mean radii over `nearly`].
    most_missed : float
        What paths may miss in all for another try with less room [sums of radii].
    hopeful : float
        Multiple of Δ up to which paths of a large fleet with full clearance are turned at a price
        of risk, once the few that miss room were planned with those in their way [-]: to turn those
        of 40 robots at 5.8 Δ took 8 s and led to no plan.
    alike : float
        Relative difference of what two attempts miss up to which it counts as the same [-].
    easy_share : float
        The share of the time that is left for a first plan of a few vehicles that nothing stops and
        that do not keep apart at once [-]: searching their sets may be as quick.
    easy_seconds, easy_most : float
        The time that it has at least [s], but no more than this share of what is left [-]. With the
        tenth alone four robots in a lane with bays, for whom the search finds none, have a plan
        within limits of 60 s, after 2 to 5 s, and none within 20.
    first_seconds, first_time_share : float
        Time after which no other attempt is begun [s], at most this share of what is left [-]; in
        large fleets among obstacles this share alone: where 30 s led to none, as on five maps, the
        search among faces led to none either.
    fastest : float
        Share of the horizon that the fastest route takes at most, when times are drawn [-].
    first_rounds : int
        Turns at a price of risk for a first plan, at most [-]; it is turned again after the search.
    enough : float
        Share of Δ in the certificate of a first plan with which its turning ends where the
        relaxation is to tell better sides [-].
    first_dear, first_dear_in_mazes : float
        Multiple of the first guess of the price at which these turns begin [-]; where obstacles
        stop most of a large fleet.
    first_share, first_share_in_mazes : float
        Share of Δ per vehicle that every half-space may risk in these sweeps [-]; there: 60 robots
        on 32 x 32 cells have first plans after 12 and 14 s with 0.2 and 6, not within 40 with 0.5
        and 3. A swarm of 200 in the open becomes 4 % dearer.
    patient_share : float
        Share of the time left for which a first plan is turned where a search would be long [-]:
        20 and 30 robots on 32 x 32 cells have plans cheaper by 5 to 14 % after 20 to 40 s with 0.5,
        and by up to 2 % more with 0.7.
    waited_rounds, waited_share : int, float
        Rounds without a plan [-], and share of the time left that they took [-], after which a
        large fleet begins otherwise: 50 robots waited 25 s for a certificate that stayed 1.1 Δ.
    many : int
        Vehicles in each other's way from which on a first plan is made before sets are searched
        [-].
    crowd : float
        Share of the fleet that these have to be as well [-]: `fleet(64)` takes half as long again
        with a first plan for five of its vehicles.
    few : int
        Vehicles of a fleet up to which one that an obstacle stops calls for the same [-]: in larger
        ones, where few meet, searching them one by one is as quick.
    stopped : float
        Share of a larger fleet that obstacles stop from which on it is not [-]: 22 % of
        `fleet(64)`, 97 % of 30 robots among 204 boxes, which got no plan in 40 s.
    many_obstacles : int
        Obstacles from which on paths of least effort are sought and beginnings compared [-]: with
        fewer, as in `paper(8)`, first plans take twice as long and are no cheaper.
    weighed : int
        Vehicles that obstacles stop up to which several routes around these are compared [-]: 20 to
        40 ms each among a hundred boxes.
    compared : float
        Clearance up to which windows count as near at a price of risk [standard deviations].
    idle : float
        Share of the gap that the vehicles of a large fleet that are left as they are could gain in
        all at most [-].
    same_side : float
        Cosine between the half-spaces of two plans above which they pass on the same side [-].
    lost : float
        Multiple of Δ from which on an estimated certificate is taken for one above Δ [-]: estimates
        are off by a tenth, seldom by a third.
    most_ratio : float
        Certificates that half-spaces' risks may sum to, to tell a price by [-]; mostly 1 to 10.
    dear : float
        Multiple of the first price at which turning begins from a plan that risks too much [-].
    time_share, seconds, most_time_share : float
        Time reserved for turning half-spaces to a plan: a share of the limit [-], or seconds [s] up
        to a larger share of it [-]. Turning takes 0.3 to 4 s on the families of the benchmarks.
    unspent : float
        Share of Δ below which a certificate leaves so much that other alternatives are tried, and
        that turning goes on whatever it took [-]: 30 robots among 204 boxes become 3 % cheaper.
    most_vehicles : int
        Vehicles of a fleet beyond which it is not planned as one without regard for risk [-].
    noiseless_share : float
        Share of the time left that a plan without regard for risk may take [-].
    most_time_from_noiseless : float
        Share of the time left after a search without a plan for turning such plans [-]: the rest is
        for the safest one.
    noiseless_nodes : int
        Nodes per vehicle for such a plan [-]; any will do.
    """

    rounds: int = 30
    most_solves: int = 400
    most_work: float = 4e8
    work_each: float = 2e6
    least_rounds: int = 2
    most_together: int = 48
    most_before_plan: int = 12
    each_before_plan: int = 5
    side_by_side: int = 12
    spacing: float = 0.12
    finer: float = 0.7
    least_spacing: float = 0.01
    ahead: float = 0.7
    crossed: float = 1.0
    first_penalty: float = 10.0
    penalty_growth: float = 1.3
    last_penalty: float = 1e4
    paced_penalty: float = 300.0
    paced_sweeps: int = 16
    misses: float = 0.02
    steady: float = 2e-3
    stuck: int = 8
    stuck_at: float = 0.9
    looks: int = 3
    further: float = 3.0
    max_sweeps: int = 40
    quick_sweeps: int = 12
    few_sweeps: int = 20
    telling: int = 3
    sooner: float = 2.5
    short: float = 0.008
    short_along: float = 0.03
    short_by_highs: float = 0.25
    attempts: int = 8
    joint_attempts: int = 3
    arches: tuple[float, ...] = (1.0, 5.0)
    most_arc: float = 4.0
    narrower: float = 0.7
    nearly: float = 0.2
    nearly_each: float = 0.1
    most_missed: float = 1.0
    first_seconds: float = 30.0
    first_time_share: float = 0.8
    hopeful: float = 3.0
    alike: float = 0.01
    easy_share: float = 0.1
    easy_seconds: float = 10.0
    easy_most: float = 0.4
    fastest: float = 0.95
    first_rounds: int = 8
    enough: float = 0.6
    first_dear: float = 3.0
    first_dear_in_mazes: float = 6.0
    first_share: float = 0.5
    first_share_in_mazes: float = 0.2
    patient_share: float = 0.7
    waited_rounds: int = 4
    waited_share: float = 0.2
    many: int = 5
    crowd: float = 0.125
    few: int = 24
    stopped: float = 0.5
    many_obstacles: int = 12
    weighed: int = 12
    compared: float = 6.5
    idle: float = 0.01
    same_side: float = 0.3
    lost: float = 1.5
    most_ratio: float = 1e3
    dear: float = 10.0
    time_share: float = 0.1
    seconds: float = 1.0
    most_time_share: float = 0.3
    unspent: float = 0.5
    most_vehicles: int = 8
    noiseless_share: float = 0.3
    most_time_from_noiseless: float = 0.5
    noiseless_nodes: int = 150


TUNING = Tuning()
"""The values in use."""
