"""The numbers that the price of risk was tuned with, in one record."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["PRICE_TUNING", "PriceControlTuning"]


@dataclass(frozen=True, slots=True)
class PriceControlTuning:
    """How the price of risk follows certificates, and when another round promises too little.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    aim, first_aim : float
        Share of Δ that the certificate is to come to at the next price [-], and the same before
        any was certified where that ends the rounds: just above Δ it comes down slowly. First
        plans of `paper(8)` in disturbances of correlation 0.8 come after 0.89 of the time.
    most_rise, most_fall : float
        Ratio of certificate to aim that a rising price follows at most, and its inverse that a
        falling one does [-]: from a cheap price paths go far at once, and not back.
    impatience : float
        Further factor on the price for every round in a row above Δ, before any was certified [-].
    patient : float
        Multiple of Δ up to which a certificate is left to the price that follows it, in fleets
        whose rounds are quick [-]: dearer at 1.05 Δ, paths of `paper(8)` in disturbances of
        correlation 0.8 came back from 0.8 Δ, a tenth of all turns.
    urgency : float
        The same as `impatience` in large fleets, whose rounds take seconds, from the first one
        above Δ on [-]: first plans of 40 and 50 robots on 32 x 32 cells come after 15 and 18 s
        with 2 instead of 19 and 24 with 1.4, and cost 2 % more.
    lost : float
        Multiple of Δ from which on a certificate calls for going back to the last certified paths
        [-].
    most_over : int
        Rounds in a row above Δ, certified before, that call for the same [-].
    dearer : float
        Factor on the price when going back [-].
    most_backs : int
        Times of going back at most [-].
    dearest : float
        Multiple of the first price that no price exceeds [-].
    damping : float
        Power of the ratio of certificate to aim that the price follows [-]: risk falls a little
        faster than in proportion.
    near, most_power : float
        Ratio of certificate to aim from which on it follows a secant instead, and the largest power
        of that [-]: in seven draws of `paper(8)` that a vehicle crosses, placed within 0.3 m, 209
        turns become 160; from the first round on, plans of `clutter(10, 100)` were 0.7 % dearer.
    enough : float
        Share of the gap below which a round gains too little to go on [-].
    spent : float
        Share of Δ below which a certificate calls for a lower price before gains are counted [-].
    nearly_spent : float
        Multiple of Δ up to which a certificate above it, of a round that gained too little, calls
        for a higher price instead of going back [-].
    nudge : float
        Further factor on the price then [-].
    negligible, negligible_of_many : float
        Share of the gap that another round must promise [-]; in large fleets. With half of the
        first, 93 turns instead of 87 on twenty draws of `paper(8)`, for 0.005 % of the cost in the
        mean and 0.05 % at most; with it `fleet(256, 0)` becomes 0.18 % dearer.
    behind, tried : float, int
        Multiple of what another round promises by which plans from elsewhere may be cheaper [-],
        after so many rounds.
    most_worse : int
        Rounds in a row of a large fleet that are dearer than a plan from elsewhere and above Δ,
        after which none follows [-]: sets of `fleet(1000, 2)` on other sides than its plan went on
        for 17 rounds, from 0.2 to 1.2 % dearer, which was a fifth of the time.
    most_idle : int
        Rounds in a row without a better certified plan, after which none follows [-]:
        `circle(4)` swings between two vertices for ever.
    max_stalls : int
        Rounds in a row that gain too little, after which none follows [-].
    less : float
        Share of the last certificate that a round must come below while far above Δ [-].
    close : float
        Multiple of Δ up to which a certificate above it is left for the price to repair [-].
    little : float
        Multiple of the gap by which the cost may move, what risk explains aside, for a plan between
        the last certified paths and those that risk too much to be looked at [-]: `paper(8)` takes
        45 turns on ten draws, 48 with 1, and among a hundred boxes that certificate takes as long
        as another turn.
    between : float
        Share of Δ that such a plan is to risk by what is linear between both [-].
    unspent, nearly : float
        Share of Δ below which a first plan on routes around obstacles is moved toward the paths
        before it, and what it is to risk then if the logarithm of the risk is linear in between
        [-]: 25 of 39 first plans become cheaper, by 1.8 % in the mean and 29 % at most, for a
        certificate each.
        Where nothing stops vehicles, that takes 1.04 of the time of `paper(8)` and 1.1 of that
        of `paper(2)`, to the same plans.
    """

    aim: float = 0.985
    first_aim: float = 0.88
    most_rise: float = 30.0
    most_fall: float = 6.0
    impatience: float = 1.4
    patient: float = 1.15
    urgency: float = 2.0
    lost: float = 8.0
    most_over: int = 5
    dearer: float = 4.0
    most_backs: int = 6
    dearest: float = 1e15
    damping: float = 0.8
    near: float = 0.85
    most_power: float = 2.0
    enough: float = 0.2
    spent: float = 0.5
    nearly_spent: float = 1.2
    nudge: float = 1.05
    negligible: float = 0.6
    negligible_of_many: float = 0.3
    behind: float = 5.0
    tried: int = 3
    most_worse: int = 2
    most_idle: int = 10
    max_stalls: int = 3
    less: float = 0.9
    close: float = 2.0
    little: float = 3.0
    between: float = 0.9985
    unspent: float = 0.9
    nearly: float = 0.97


PRICE_TUNING = PriceControlTuning()
"""The values in use."""
