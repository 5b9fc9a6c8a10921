"""The content of a plan file, and what the referee says of it while planners search."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import scipy

from radmpc.arrays import Matrix
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.outcome.trajectories import cost_of, trajectories_of
from radmpc.planners.planner import Planner
from radmpc.planners.verdict import Judge, RoughJudge, Verdict
from radmpc.referee.bound.certificate import (
    Certificate,
    judged,
    ledger_under,
    rough_risk_under,
)
from radmpc.referee.propagation import FleetNoise
from radmpc.version import __version__

__all__ = ["Certifying", "plan_of"]

_REMEMBERED = 8
"""Certificates that are remembered [-]."""


class Certifying:
    """The referee, for planners to ask while they search; remembers the latest certificates.

    A plan is judged where it is found, and again where it is handed on.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    planner : Planner
        Who asks.
    """

    def __init__(self, scenario: Scenario, planner: Planner) -> None:
        self._of = scenario, planner
        self._latest: dict[bytes, Verdict] = {}

    def __call__(self, controls: tuple[Matrix, ...]) -> Certificate:
        """Return the certificate of every vehicle's controls, in the scenario's order."""
        scenario, planner = self._of
        everyone = (tuple(range(scenario.num_vehicles)),)
        draft = Draft(Status.FEASIBLE, controls, everyone, (), (), {})
        trajectories = trajectories_of(scenario, controls)
        return self.certificate(plan_of(scenario, planner, None, draft, trajectories, None, {}))

    def certificate(self, plan: Plan) -> Certificate:
        """Return the certificate of a plan of the scenario; what it risks may be remembered.

        Parameters
        ----------
        plan : Plan
            With trajectories.
        """
        verdict = self.verdict(tuple(t.controls for t in plan.trajectories))
        return judged(plan, self._noise, (verdict.certified, verdict.ledger))

    @cached_property
    def _noise(self) -> FleetNoise:
        """What the referee needs to know of the fleet, whatever the controls."""
        return FleetNoise.of(self._of[0])

    @property
    def judge(self) -> Judge:
        """The referee as planners ask it: along intervals it tells roughly, too."""
        is_quick = self._of[0].avoidance == "intervals"
        return RoughJudge(self.verdict, self.rough) if is_quick else self.verdict

    def rough(self, controls: tuple[Matrix, ...]) -> float:
        """Return what the plan risks at most, as is quickly found [-]."""
        return rough_risk_under(self._noise, controls)

    def verdict(self, controls: tuple[Matrix, ...]) -> Verdict:
        """Return what planners need of it: what the plan risks, and where."""
        key = b"".join(each.tobytes() for each in controls)
        if key not in self._latest:
            if len(self._latest) >= _REMEMBERED:
                del self._latest[next(iter(self._latest))]
            self._latest[key] = Verdict(*ledger_under(self._noise, controls))
        return self._latest[key]


def plan_of(
    scenario: Scenario,
    planner: Planner,
    seed: int | None,
    draft: Draft,
    trajectories: tuple[Trajectory, ...],
    certificate: Certificate | None,
    seconds: Mapping[str, float],
) -> Plan:
    """Return the content of the plan file.

    Parameters
    ----------
    scenario : Scenario
        What was planned.
    planner : Planner
        By whom.
    seed : int or None
        Of its random choices, where it was a number.
    draft : Draft
        What it came to.
    trajectories : tuple of Trajectory
        What follows from its controls; empty of no plan.
    certificate : Certificate or None
        What the referee says of them; None before it was asked.
    seconds : mapping of str to float
        Per stage, and ``total`` [s].
    """
    risk = Risk(scenario.risk_bound)
    if certificate is not None:
        risk = Risk(
            scenario.risk_bound,
            certificate.certified,
            certificate.ledger,
            draft.price,
            certificate.saturation,
        )
    cost = cost_of(scenario, trajectories) if trajectories else None
    bound, on_any = draft.lower_bound, draft.certified_lower_bound
    # The same cost, summed in another order, differs by rounding.
    if cost is not None and bound is not None:
        bound = min(bound, cost)
    if cost is not None and on_any is not None:
        on_any = min(on_any, cost)
    return Plan(
        scenario=scenario,
        planner=str(planner),
        seed=seed,
        status=draft.status,
        cost=cost,
        lower_bound=bound,
        risk=risk,
        sets=tuple(tuple(scenario.vehicles[i].name for i in s) for s in draft.sets),
        seconds=seconds,
        versions=dict(_versions()),
        explanation=draft.explanation,
        trajectories=trajectories,
        couplings=draft.couplings,
        stopped_by=draft.stopped_by,
        certified_lower_bound=on_any,
        first=draft.first,
    )


@cache
def _versions() -> dict[str, str]:
    """Return the versions a plan depends on."""
    try:
        highspy = version("highspy")
    except PackageNotFoundError:  # pragma: no cover - a vendored copy without metadata
        highspy = "unknown"
    return {
        "radmpc": __version__,
        "python": platform.python_version(),
        "highspy": highspy,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }
