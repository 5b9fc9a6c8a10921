"""One window of a long mission: a mission of its own that goes on with what is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from radmpc.arrays import Vector
from radmpc.flying.knowing import expected_start, renewed
from radmpc.flying.mission import Mission
from radmpc.flying.remainder import changed, left_of
from radmpc.flying.sensing.alarms import Watcher
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.sensing.measurements import Sensing
from radmpc.flying.sensing.observing import Observer
from radmpc.flying.visiting import still_to_do
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.conditional.scales import Scale

__all__ = ["Handover", "Window", "scene_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Handover:
    """What a window leaves to the next one.

    Attributes
    ----------
    estimates : tuple of array
        What is known of vehicles: see `radmpc.flying.knowing`.
    alarms : tuple of str
        Of the measurement that it is known by.
    evidence : Evidence
        What was measured of covariances known up to a factor.
    squares : tuple of (float, int, Scale)
        What speaks against the model: see `radmpc.flying.sensing.alarms.Watcher`.
    wealth : float
        Remaining risk, by the account [-].
    visits : tuple of int
        Of each vehicle, visits of the window that are not made yet.
    arrived : tuple of bool
        Of each vehicle, whether it is at a goal that it was to reach within a window of steps.
    """

    estimates: tuple[Vector, ...]
    alarms: tuple[str, ...]
    evidence: Evidence
    squares: tuple[tuple[float, int, Scale], ...]
    wealth: float
    visits: tuple[int, ...]
    arrived: tuple[bool, ...]


class Window(Mission):
    """A mission over some steps of a longer one.

    Parameters
    ----------
    plan : Plan
        Of these steps.
    ahead : Scenario
        The longer mission up to the last of these steps.
    began : int
        Step of the longer mission at which the window begins.
    before : Handover or None
        What is known there, by what was measured there; None is nothing.
    **options
        As in `Mission`.
    """

    _bound_name = "the window's share of Δ, "

    def __init__(
        self, plan: Plan, ahead: Scenario, began: int, before: Handover | None, **options: Any
    ) -> None:
        super().__init__(plan, **options)
        self._began = began
        # One filter from the longer mission's first step on: of vehicles that learn of each other
        # what a window's own plan begins with does not tell all.
        watcher, evidence = Watcher(ahead), Evidence.of(ahead, -began)
        if before is not None:
            watcher.squares.extend(before.squares)
            evidence = replace(before.evidence, scenario=ahead, began=-began)
            self._leg = replace(self._leg, scale=evidence.scale)
            self._sources.renew(self._leg, self._clock)
            self._known = self._expected = renewed(plan.scenario.vehicles, before.estimates)
        self._sensing = Sensing(watcher, Observer.of(ahead, -began), evidence)
        if before is not None:
            self._sensing.seen = 0, self._expected, before.alarms

    @property
    def began(self) -> int:
        """Step of the longer mission at which the window begins."""
        return self._began

    def handover(self, states: Sequence[Vector]) -> Handover:
        """Return what the next window goes on with, were it to begin now.

        Parameters
        ----------
        states : sequence of (n,) array
            Measured states, or estimates.
        """
        is_certain = not self._ticks or self._ticks[-1].value is not None
        seen = self._step, self._expected, states, self._leg
        known, alarms = self._sensing.look(*seen, is_certain=is_certain)
        evidence, squares = self._sensing.evidence, tuple(self._sensing.watcher.squares)
        value = self._leg.value(self._step, known, evidence.scale)
        wealth = self._account.kept(value.least).wealth
        visits, arrivals = still_to_do(self._leg, self._step)
        return Handover(known, tuple(alarms), evidence, squares, wealth, visits, arrivals)


def scene_of(
    ahead: Scenario, step: int, risk_bound: float, before: Handover | None
) -> tuple[Scenario, tuple[Vector, ...], Scale]:
    """Return the scenario of a window, and what is known where it begins, of covariances, too.

    Parameters
    ----------
    ahead : Scenario
        The longer mission up to the window's last step.
    step : int
        Of the longer mission, at which the window begins; 0 where nothing was measured yet.
    risk_bound : float
        What the window may risk [-].
    before : Handover or None
        What is known there; None is nothing.
    """
    if before is None:
        known = tuple(expected_start(vehicle) for vehicle in ahead.vehicles)
        return changed(ahead, risk_bound=risk_bound), known, Scale(ahead.covariance_samples)
    scale = before.evidence.scale
    return left_of(ahead, step, before.estimates, risk_bound, scale), before.estimates, scale
