"""Which sets have been merged, and why; `radmpc.planners.certified.rounds` decides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Indices
from radmpc.model.plan import Coupling
from radmpc.model.relations.keep import keep_pairs
from radmpc.model.scenario import Scenario
from radmpc.planners.verdict import Verdict
from radmpc.records import dataclass, field, replace

__all__ = ["Members", "Merging", "owners_of"]

Members = tuple[int, ...]
"""The vehicles of a set, by their numbers in the scenario, ascending."""

_TELLING = 1e-3
"""Share of the worst pair risk between two sets below which a pair does not explain why they were
merged [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Merging:
    """Why sets that were planned apart are planned together; what is learned makes a new one.

    Attributes
    ----------
    scenario : Scenario
        The fleet.
    coupling_risks : mapping of (int, int) to float
        The largest risk that two vehicles ran in plans made apart, for pairs whose sets were
        merged [-].
    rejected_pairs : mapping of (int, int) to float
        Pairs for which the referee rejected plans made apart, with their risk there [-]: planned
        together from then on, at every price.
    """

    scenario: Scenario
    coupling_risks: Mapping[tuple[int, int], float] = field(default_factory=dict)
    rejected_pairs: Mapping[tuple[int, int], float] = field(default_factory=dict)

    @classmethod
    def of(cls, scenario: Scenario) -> Merging:
        """Begin with vehicles that keep a range planned together, whatever they risk apart."""
        names = [vehicle.name for vehicle in scenario.vehicles]
        pairs = keep_pairs(scenario.keep, names)
        return cls(scenario, rejected_pairs={(i, j): 1.0 for i, j, _ in pairs})

    def reject(self, sets: Sequence[Members], verdict: Verdict) -> Merging | None:
        """Plan the pairs across sets that a rejected plan is to be blamed on together.

        Parameters
        ----------
        sets : sequence of tuple of int
            The partition of the fleet that was judged.
        verdict : Verdict
            What the referee says of its plan.

        Returns
        -------
        Merging or None
            With those pairs; None where there are no such pairs.
        """
        numbers = {v.name: i for i, v in enumerate(self.scenario.vehicles)}
        rejected = verdict.to_blame(owners_of(sets), numbers, self.scenario.risk_bound)
        if not rejected:
            return None
        return replace(self, rejected_pairs={**self.rejected_pairs, **rejected})

    def reject_hidden(
        self, sets: Sequence[Members], verdict: Verdict, estimate: float
    ) -> Merging | None:
        """Reject a plan where the referee finds more between sets than was estimated.

        Parameters
        ----------
        sets : sequence of tuple of int
            The partition of the fleet that was judged.
        verdict : Verdict
            What the referee says of its plan.
        estimate : float
            Risk between sets up to which the estimate counts as right [-].

        Returns
        -------
        Merging or None
            With the pairs that are planned together because of it; None where there are none.
        """
        numbers = {v.name: i for i, v in enumerate(self.scenario.vehicles)}
        across = verdict.across(owners_of(sets), numbers)
        return self.reject(sets, verdict) if sum(across.values()) > estimate else None

    def to_merge(self, sets: Sequence[Members]) -> dict[tuple[int, int], float]:
        """Return the rejected pairs of vehicles of different sets, with their risks."""
        owners = owners_of(sets)
        return {
            pair: r for pair, r in self.rejected_pairs.items() if owners[pair[0]] != owners[pair[1]]
        }

    def remember(
        self,
        apart: Sequence[Members],
        merged: Sequence[Members],
        pair_risks: Mapping[tuple[int, int], float],
    ) -> Merging:
        """Note which pairs of vehicles made sets planned apart into one.

        Parameters
        ----------
        apart, merged : sequence of tuple of int
            The partition of the fleet before and after.
        pair_risks : mapping of (int, int) to float
            Risks between vehicles of different sets, lower number first, when planned apart [-].

        Returns
        -------
        Merging
            With these.
        """
        old, new = owners_of(apart).tolist(), owners_of(merged).tolist()
        inside = {pair: risk for pair, risk in pair_risks.items() if new[pair[0]] == new[pair[1]]}
        worst: dict[tuple[int, int], float] = {}
        for (i, j), risk in inside.items():
            key = (min(old[i], old[j]), max(old[i], old[j]))
            worst[key] = max(worst.get(key, 0.0), risk)
        coupling_risks = dict(self.coupling_risks)
        for (i, j), risk in inside.items():
            if risk >= _TELLING * worst[min(old[i], old[j]), max(old[i], old[j])]:
                coupling_risks[i, j] = max(coupling_risks.get((i, j), 0.0), risk)
        return replace(self, coupling_risks=coupling_risks)

    def couplings(self, sets: Sequence[Members]) -> tuple[Coupling, ...]:
        """Return why the vehicles of these sets were planned together."""
        owners = owners_of(sets)
        names = [vehicle.name for vehicle in self.scenario.vehicles]
        kept = {(i, j): within for i, j, within in keep_pairs(self.scenario.keep, names)}
        return tuple(
            Coupling(names[i], names[j], "range", kept[i, j])
            if (i, j) in kept
            else Coupling(names[i], names[j], "collision", self.coupling_risks[i, j])
            for i, j in sorted({*self.coupling_risks, *kept})
            if owners[i] == owners[j]
        )


def owners_of(sets: Sequence[Members]) -> Indices:
    """Return the number of every vehicle's set, (N,), of a partition of the fleet."""
    owners = np.empty(sum(len(members) for members in sets), dtype=np.int64)
    for number, members in enumerate(sets):
        owners[list(members)] = number
    return owners
