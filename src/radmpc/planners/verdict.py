"""What the referee says of a plan, and which vehicles planned apart are to blame for it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from radmpc.arrays import Indices, Matrix
from radmpc.model.plan import LedgerRow
from radmpc.records import dataclass

__all__ = ["Judge", "RoughJudge", "Verdict"]

_BESIDES = 0.1
"""Share of Δ that pairs across sets may keep together when the worst of them are merged [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """A certificate as planners need it.

    Attributes
    ----------
    certified : float
        Upper bound on the probability of any collision [-].
    ledger : iterable of LedgerRow
        Where it goes; empty where the plan cannot be judged.
    """

    certified: float
    ledger: Iterable[LedgerRow]

    def across(self, owners: Indices, numbers: Mapping[str, int]) -> dict[tuple[int, int], float]:
        """Return the risk of every pair of vehicles of different sets, lower number first.

        Parameters
        ----------
        owners : (N,) int array
            The set of each vehicle.
        numbers : mapping of str to int
            Every vehicle's number by its name.
        """
        found: dict[tuple[int, int], float] = {}
        for row in self.ledger:
            # What is far from a vehicle is charged without a partner.
            if row.cause != "pair" or row.other is None:
                continue
            i, j = sorted((numbers[row.vehicle], numbers[row.other]))
            if owners[i] != owners[j]:
                found[i, j] = found.get((i, j), 0.0) + row.risk
        return found

    def to_blame(
        self, owners: Indices, numbers: Mapping[str, int], risk_bound: float
    ) -> dict[tuple[int, int], float]:
        """Return the worst pairs across sets, where without them the plan might be within Δ.

        Parameters
        ----------
        owners, numbers : Indices and mapping
            As in `across`.
        risk_bound : float
            Δ [-].

        Returns
        -------
        dict
            Their risks; empty where the plan is within Δ, or is not without such pairs either.
        """
        pairs = self.across(owners, numbers)
        left = sum(pairs.values())
        if self.certified <= risk_bound or left < min(risk_bound, self.certified - risk_bound):
            return {}
        blamed: dict[tuple[int, int], float] = {}
        for pair, risk in sorted(pairs.items(), key=lambda item: (-item[1], item[0])):
            if left <= _BESIDES * risk_bound and blamed:
                break
            blamed[pair] = risk
            left -= risk
        return blamed


Judge = Callable[[tuple[Matrix, ...]], Verdict]
"""The referee's verdict on every vehicle's controls, in the scenario's order."""


@dataclass(frozen=True, slots=True, eq=False)
class RoughJudge:
    """The referee where it also tells quickly what risk is at most.

    Attributes
    ----------
    verdict : callable
        Its verdict.
    rough : callable
        Returns an upper bound on the certificate that takes a fraction of the time [-].
    """

    verdict: Judge
    rough: Callable[[tuple[Matrix, ...]], float]

    def __call__(self, controls: tuple[Matrix, ...]) -> Verdict:
        """Return the verdict on every vehicle's controls."""
        return self.verdict(controls)
