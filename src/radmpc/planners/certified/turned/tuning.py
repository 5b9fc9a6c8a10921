"""The numbers that turning half-spaces was tuned with, in one record."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How long half-spaces are turned, and at which price.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    rounds : int
        Turns at most [-], twice as many from a plan that risks too much. The families of the
        benchmarks take 4 to 12 and mostly stop when little is gained; the first few often exceed Δ
        and are lost.
    most_solves, least_rounds : int
        Solves of sets after which no round is begun [-], but for so many rounds of all sets: large
        fleets gain little by the solve, and a count, unlike a clock, gives the same plan on any
        machine.
    nodes : int
        Nodes per set and round [-]: avoidances have one alternative, nodes only add what comes
        near.
    near : float
        Clearance up to which an avoidance is chosen from the first node on [standard deviations].
    aim : float
        Share of Δ that the certificate is to come to at the next price [-].
    most_move : float
        Ratio of certificate to aim that a price follows at most, either way [-].
    damping : float
        Power of the ratio of certificate to aim that the price follows [-]: risk falls a little
        faster than in proportion.
    enough : float
        Share of the gap below which a round gains too little to go on [-].
    max_stalls : int
        Rounds in a row that gain too little, after which none follows [-].
    less : float
        Share of the least certificate so far that a round must come below while far above Δ [-].
    close : float
        Multiple of Δ up to which a certificate above it is left for the price to repair [-].
    dear : float
        Multiple of the first price at which turning begins from a plan that risks too much [-].
    slack : float
        What the rows may sum to, in multiples of what they do at the plan they are turned to [-].
    still : float
        Share of the gap below which the change of a set's controls counts as nothing [-].
    same_price : float
        Relative difference of prices up to which a set that has converged is left alone [-].
    time_share, seconds, most_time_share : float
        Time reserved for turning half-spaces to a plan: a share of the limit [-], or seconds [s] up
        to a larger share of it [-]. Turning takes 0.3 to 4 s on the families of the benchmarks.
    least_seconds : float
        Time that turning gets at least, if the limit leaves it [s].
    unspent : float
        Share of Δ below which a certificate leaves so much that other alternatives are tried [-].
    most_vehicles : int
        Vehicles of a fleet beyond which it is not planned as one without regard for risk [-].
    noiseless_seconds, noiseless_share : float
        Time for a plan without regard for risk [s], at most this share of what is left [-].
    noiseless_nodes : int
        Nodes per vehicle for such a plan [-]; any will do.
    """

    rounds: int = 12
    most_solves: int = 48
    least_rounds: int = 2
    nodes: int = 400
    near: float = 12.0
    aim: float = 0.97
    most_move: float = 30.0
    damping: float = 0.8
    enough: float = 0.2
    max_stalls: int = 2
    less: float = 0.9
    close: float = 2.0
    dear: float = 10.0
    slack: float = 1.1
    still: float = 0.1
    same_price: float = 0.3
    time_share: float = 0.1
    seconds: float = 1.0
    most_time_share: float = 0.3
    least_seconds: float = 6.0
    unspent: float = 0.5
    most_vehicles: int = 8
    noiseless_seconds: float = 2.0
    noiseless_share: float = 0.3
    noiseless_nodes: int = 150


TUNING = Tuning()
"""The values in use."""
