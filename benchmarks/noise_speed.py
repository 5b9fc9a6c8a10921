"""How long planning takes under each assumption on the noise, against the same scene without it.

    python benchmarks/noise_speed.py [--vehicles N] [--seeds N] [--gap G] [--seconds S] [--only X]

Problems are `paper(N)`, the planner is `certified`, asked for a gap of G: until its first
certified plan, and until it ends, by a proof of the gap or by its limit. Reference and assumption,
those of `assumptions.py`, take turns in one run, and whichever goes first changes from seed to
seed. What lasts adds up, and makes another problem; so it is held, too, against new noise that
strays as far by the end, as what crosses is against an outline that is known but larger by three
deviations, and few samples against known noise that takes as wide a margin at a risk of 1e-3.
Seconds are the processor's, of the thread that plans (NumPy's own wait for work that a gain was
computed with); ratios are taken seed by seed, and the table has their medians, the largest, how
many ended with a proof, and how far plans are at most from any other that the referee would
certify, in the mean of those that have a plan under both.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass, replace
from statistics import mean, median
from unittest.mock import patch

import numpy as np

import radmpc
from assumptions import ASSUMPTIONS, Assumption
from radmpc.experiments.families import paper
from radmpc.gaussian import GAUSSIAN, Tail
from radmpc.planners import Branch, Certified, Optimal, Planner


@dataclass(frozen=True, slots=True)
class Taken:
    """What one plan took.

    Attributes
    ----------
    first : float
        Seconds until the first certified plan [s]; inf without one.
    whole : float
        Seconds until the planner ended [s].
    is_proven : bool
        Whether it ended with a proof rather than at its limit.
    gap : float
        To any certified plan [-]; nan without a plan.
    """

    first: float
    whole: float
    is_proven: bool
    gap: float


def _straying_as_far(change: Assumption) -> Assumption:
    """Let noise be new at every step, and stray as far by the end as under a change."""

    def changed(scenario: radmpc.Scenario) -> radmpc.Scenario:
        """Multiply every vehicle's disturbance."""
        fleet = []
        for vehicle, lasting in zip(scenario.vehicles, change(scenario).vehicles, strict=True):
            far = np.trace(lasting.covariances(scenario.horizon)[-1][:2, :2])
            still = replace(vehicle, disturbance_covariance=0.0)
            none = np.trace(still.covariances(scenario.horizon)[-1][:2, :2])
            own = np.trace(vehicle.covariances(scenario.horizon)[-1][:2, :2])
            more = (far - none) / (own - none)
            fleet.append(
                replace(vehicle, disturbance_covariance=more * vehicle.disturbance_covariance)
            )
        return replace(scenario, vehicles=tuple(fleet))

    return changed


def _grown(change: Assumption) -> Assumption:
    """Let what crosses be known, and larger by three of its deviations at half time."""

    def changed(scenario: radmpc.Scenario) -> radmpc.Scenario:
        """Give the last obstacle a larger outline and no noise."""
        *others, crossing = change(scenario).obstacles
        assert crossing.spread is not None
        more = 3.0 * crossing.spread.deviation(scenario.horizon // 2)
        corners = crossing.at(0)[0].vertices
        middle = corners.mean(axis=0)
        outline = corners - middle + more * np.sign(corners - middle)
        velocity = (crossing.at(1)[0].vertices - corners)[0] / scenario.dt
        known = radmpc.Obstacle.tracked("crossing", outline, [*middle, *velocity], [0.0] * 4)
        return replace(scenario, obstacles=(*others, known))

    return changed


def _as_wide(change: Assumption) -> Assumption:
    """Let noise be known, and take as wide a margin at a risk of 1e-3 as under a change."""

    def changed(scenario: radmpc.Scenario) -> radmpc.Scenario:
        """Multiply all covariances."""
        unsure = Tail(change(scenario).covariance_samples)
        more = float(unsure.clearance_for(1e-3) / GAUSSIAN.clearance_for(1e-3)) ** 2
        fleet = [
            replace(
                vehicle,
                initial_covariance=more * vehicle.initial_covariance,
                disturbance_covariance=more * vehicle.disturbance_covariance,
            )
            for vehicle in scenario.vehicles
        ]
        return replace(scenario, vehicles=tuple(fleet))

    return changed


_LASTS, _CROSSES = "disturbances that last, correlation 0.8", "somebody crosses, place within 0.3 m"
_FEW = "covariances from 10 steps"

PAIRS = {
    **ASSUMPTIONS,
    f"{_LASTS}, against as far astray": (
        _straying_as_far(ASSUMPTIONS[_LASTS][1]),
        ASSUMPTIONS[_LASTS][1],
    ),
    f"{_FEW}, against margins as wide": (_as_wide(ASSUMPTIONS[_FEW][1]), ASSUMPTIONS[_FEW][1]),
    f"{_CROSSES}, against a larger one": (
        _grown(ASSUMPTIONS[_CROSSES][1]),
        ASSUMPTIONS[_CROSSES][1],
    ),
}
"""What is assumed, by name: the reference and the assumption."""


def taken(scenario: radmpc.Scenario, gap: float, seconds: float) -> Taken:
    """Plan and tell what it took.

    Parameters
    ----------
    scenario : Scenario
        The problem.
    gap : float
        At which the planner ends [-].
    seconds : float
        At which it ends in any case [s].
    """
    moments: list[float] = []

    def seen(plan: radmpc.Plan) -> None:
        """Note the moment of the first certified plan."""
        risk = plan.risk.certified
        if not moments and risk is not None and risk <= plan.risk.bound:
            moments.append(time.thread_time())

    with patch("time.monotonic", time.thread_time):
        begun = time.thread_time()
        planner = Planner(Optimal(), Branch(), Certified(), gap=gap)
        found = radmpc.plan(scenario, planner, rng=0, time_limit=seconds, improved=seen)
        whole = time.thread_time() - begun
    first = moments[0] - begun if moments else whole if found.is_certified else math.inf
    gap = None if found.plan is None else found.plan.certified_gap
    return Taken(
        first, whole, found.status is radmpc.Status.OPTIMAL, math.nan if gap is None else gap
    )


def compared(name: str, asked: argparse.Namespace) -> str:
    """Return the line of an assumption."""
    first, whole, proven = list[float](), list[float](), [0, 0]
    gaps: tuple[list[float], list[float]] = ([], [])
    for seed in range(asked.seeds):
        order = (0, 1) if seed % 2 == 0 else (1, 0)
        scene = paper(asked.vehicles, seed)
        told = {i: taken(PAIRS[name][i](scene), asked.gap, asked.seconds) for i in order}
        for i in order:
            proven[i] += told[i].is_proven
        if math.isfinite(told[0].first) and math.isfinite(told[1].first):
            first.append(told[1].first / told[0].first)
            whole.append(told[1].whole / told[0].whole)
            for each, one in zip(gaps, (told[0], told[1]), strict=True):
                each.append(one.gap)
    if not first:
        return f"| {name} | – | – | – | – | {proven[0]}, {proven[1]} | – |"
    cells = [f"{f(ratios):.2f}" for ratios in (first, whole) for f in (median, max)]
    left = ", ".join(f"{100.0 * mean(each):.2f}" for each in gaps)
    proofs = f"{proven[0]}, {proven[1]} of {asked.seeds}"
    return f"| {name} | {' | '.join(cells)} | {proofs} | {left} % |"


def main() -> None:
    """Print one line per assumption."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--vehicles", type=int, default=8)
    parser.add_argument("--seeds", type=int, default=7)
    parser.add_argument("--gap", type=float, default=1e-3)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--only", help="assumptions whose name contains this")
    asked = parser.parse_args()
    if not any((asked.only or "") in name for name in PAIRS):
        parser.error(f"no assumption has {asked.only!r} in its name")
    taken(paper(2, 0), asked.gap, 2.0)  # what is loaded at first use
    head = "first plan | most | to the end | most | proven without, with | gap to any"
    print(f"| assumption | {head} |")
    print("|---|---|---|---|---|---|---|")
    for name in PAIRS:
        if not asked.only or asked.only in name:
            print(compared(name, asked), flush=True)


if __name__ == "__main__":
    main()
