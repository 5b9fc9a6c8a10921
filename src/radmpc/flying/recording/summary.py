"""What a flight comes to, from its record alone: rates, effort, goals missed, how ticks went."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.flying.candidates.times import CUT_OFF
from radmpc.flying.commanding import let_pass
from radmpc.flying.deciding import opened
from radmpc.io.flight.record import FlightRecord, FlownMission, TickRow
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.claims.claims import planned_effort
from radmpc.referee.simulation.simulation import Simulation

__all__ = ["FlightSummary", "summary_of"]


@dataclass(frozen=True, slots=True, eq=False)
class FlightSummary:
    """What a flight comes to; of missions, those that were flown to their end count.

    Attributes
    ----------
    flown : Simulation or None
        Missions as samples: how many collide, with what, and saturate; None if none is over.
    asked : int
        How many missions were asked for.
    bound, certified : float
        Δ, and the certificate of the plan that was flown first [-].
    effort : float or None
        Mean of ``Σ weight · ‖u‖₁`` as flown.
    effort_planned : float
        The same of the plan.
    miss : float or None
        Mean distance by which a vehicle ends outside its goal [m].
    accepted : float or None
        Share of ticks at which another leg was adopted [-].
    adopted : int
        How many they are.
    alarms : int
        In all ticks.
    ticks : int
        Decisions, of missions under way, too.
    tick_p50, tick_p99, tick_max : float or None
        What decisions took [s].
    late : int or None
        Decisions that took longer than the deadline; None without one.
    cut_off : int or None
        Those for which it left no other leg: none was found in time, or it was there too late.
    """

    flown: Simulation | None
    asked: int
    bound: float
    certified: float
    effort: float | None
    effort_planned: float
    miss: float | None
    accepted: float | None
    adopted: int
    alarms: int
    ticks: int
    tick_p50: float | None
    tick_p99: float | None
    tick_max: float | None
    late: int | None
    cut_off: int | None = None

    @property
    def missions(self) -> int:
        """How many missions were flown to their end."""
        return 0 if self.flown is None else self.flown.samples

    @property
    def contradiction(self) -> str | None:
        """How the rate speaks against the bound; None where it does not."""
        if self.flown is None or self.flown.rate_low <= self.bound:
            return None
        return (
            f"the collision rate is at least {self.flown.rate_low:.4g} with 97.5 % confidence, "
            f"above the risk bound {self.bound:g}"
        )


def summary_of(record: FlightRecord) -> FlightSummary:
    """Return what a flight comes to.

    Parameters
    ----------
    record : FlightRecord
        Read from a file or just flown.

    Returns
    -------
    FlightSummary
        Of the missions that are over, and of the ticks of all.

    Raises
    ------
    RiskError
        If the plan's certificate exceeds Δ.
    """
    scenario = record.plan.scenario
    missions = [mission for mission in record.missions if mission.is_over]
    decided = [row for row in record.rows if row.controls]
    adopted = sum(row.leg is not None for row in decided)
    seconds, deadline = np.array([row.seconds for row in decided]), record.settings.deadline
    p50, p99 = np.quantile(seconds, [0.5, 0.99]).tolist() if seconds.size else (None, None)
    efforts = [effort_of(scenario, mission) for mission in missions]
    misses = [miss_of(scenario, row) for row in (mission.rows[-1] for mission in missions)]
    told = [miss for miss in misses if miss is not None]
    return FlightSummary(
        flown=_counted(scenario, missions) if missions else None,
        asked=record.settings.missions,
        bound=scenario.risk_bound,
        certified=opened(record.plan, 0)[0].price,
        effort=float(np.mean(efforts)) if efforts else None,
        effort_planned=planned_effort(record.plan),
        miss=float(np.mean(told)) if told else None,
        accepted=adopted / len(decided) if decided else None,
        adopted=adopted,
        alarms=sum(len(row.alarms) for row in record.rows),
        ticks=len(record.rows),
        tick_p50=p50,
        tick_p99=p99,
        tick_max=float(seconds.max()) if seconds.size else None,
        late=None if deadline is None else int(np.count_nonzero(seconds > deadline)),
        cut_off=None if deadline is None else sum(map(_is_cut_off, decided)),
    )


def _is_cut_off(row: TickRow) -> bool:
    """Whether a deadline left no other leg for a decision."""
    return row.leg is None and row.reason in CUT_OFF


def effort_of(scenario: Scenario, mission: FlownMission) -> float:
    """Return ``Σ weight · ‖u‖₁`` as flown.

    Parameters
    ----------
    scenario : Scenario
        For the weights.
    mission : FlownMission
        Its rows.
    """
    return sum(
        v.cost_weight * float(np.abs(u).sum())
        for row in mission.rows
        if row.controls
        for v, u in zip(scenario.vehicles, row.controls, strict=True)
    )


def miss_of(scenario: Scenario, row: TickRow) -> float | None:
    """Return the mean distance by which vehicles are outside their goals [m].

    Parameters
    ----------
    scenario : Scenario
        For the goals.
    row : TickRow
        The last of a mission; None where nothing was measured.
    """
    if row.states is None:
        return None
    return float(
        np.mean(
            [
                np.linalg.norm(_outside(v.goal.lower, v.goal.upper, x[list(v.system.position)]))
                for v, x in zip(scenario.vehicles, row.states, strict=True)
            ]
        )
    )


def _outside(lower: Vector, upper: Vector, place: Vector) -> Vector:
    """Return how far a place is outside of a box, along each axis."""
    return np.asarray(np.maximum(np.maximum(lower - place, place - upper), 0.0))


def _counted(scenario: Scenario, missions: list[FlownMission]) -> Simulation:
    """Return missions as samples."""
    causes = [{touch.cause for touch in mission.contacts} for mission in missions]
    least = let_pass(scenario.vehicles)
    saturated = sum(any(row.excess > least for row in mission.rows) for mission in missions)
    return Simulation(
        samples=len(missions),
        collisions=sum(bool(found) for found in causes),
        pair_collisions=sum("pair" in found for found in causes),
        obstacle_collisions=sum("obstacle" in found for found in causes),
        workspace_exits=sum("workspace" in found for found in causes),
        saturated=saturated,
        overlooked=0.0,
        range_losses=sum("range" in found for found in causes),
    )
