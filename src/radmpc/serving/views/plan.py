"""A plan, ready to be drawn: paths, discs, where the risk goes, and what is to be said of it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Coupling, LedgerRow, Plan, Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.serving.protocol import (
    CouplingView,
    LedgerLine,
    PlanSummary,
    PlanView,
    Remark,
    ScenarioView,
    TrackView,
)
from radmpc.serving.views.ellipses import ellipses_of
from radmpc.serving.views.numbers import Rounding, extent_of, significant
from radmpc.serving.views.scenario import scenario_view
from radmpc.serving.wording import for_page

__all__ = ["mean_path", "plan_summary", "plan_view"]

_SIGMAS = 3.0
"""Size of the discs [standard deviations], that of pictures."""

_MOST_POINTS = 60_000
"""Points of all paths together, so that a fleet of a thousand stays a few megabytes [-]."""

_PARTS = 4
"""Parts of a step that a curved path is told with [-]."""

_MOST_LINES, _NOTHING = 4000, 1e-7
"""Lines of a ledger that are told, and the share of Δ from which on one is [-]."""


_TOLD = 1e-15
"""Probability of saturation from which on it is told [-]; less is rounding."""


def plan_summary(plan: Plan, number: str, revision: int) -> PlanSummary:
    """Return a plan in few words.

    Parameters
    ----------
    plan : Plan
        Also one without trajectories.
    number : str
        By which the server keeps it.
    revision : int
        Of the document that it is of.
    """
    certified, bound = plan.risk.certified, plan.lower_bound
    if plan.certified_lower_bound is not None:
        bound = max(bound or 0.0, plan.certified_lower_bound)
    return {
        "plan": number,
        "revision": revision,
        "planner": plan.planner,
        "status": plan.status.value,
        "riskBound": plan.risk.bound,
        "cost": significant(plan.cost),
        "bound": significant(bound),
        "certified": significant(certified),
        "holds": certified is not None and certified <= plan.risk.bound,
        "seconds": round(plan.seconds.get("total", 0.0), 3),
        "price": significant(plan.risk.price),
        "explanation": plan.explanation and for_page(plan.explanation),
    }


def plan_view(
    plan: Plan,
    summary: PlanSummary,
    scenario: ScenarioView | None = None,
    remarks: Sequence[Remark] = (),
) -> PlanView:
    """Return a plan as the page draws it.

    Parameters
    ----------
    plan : Plan
        Also one without trajectories.
    summary : PlanSummary
        The plan in few words.
    scenario : ScenarioView or None
        The scenario that it is of, if it was made before.
    remarks : sequence of Remark
        Why there is no better one.
    """
    world = plan.scenario
    rounding = Rounding.of(*extent_of(world))
    curved = any(v.system.is_double_integrator for v in world.vehicles)
    points = world.num_vehicles * world.horizon
    per_step = max(1, min(_PARTS, _MOST_POINTS // max(points, 1))) if curved else 1
    pairs = list(zip(world.vehicles, plan.trajectories, strict=False))
    d = world.dimension
    certified, saturation = plan.risk.certified, plan.risk.saturation
    return {
        "plan": summary["plan"],
        "summary": summary,
        "scenario": scenario_view(world) if scenario is None else scenario,
        "perStep": per_step,
        "tracks": [_track(v, t, per_step, rounding) for v, t in pairs],
        "ledger": _ledger(plan, rounding),
        "left": plan.risk.bound if certified is None else max(plan.risk.bound - certified, 0.0),
        "saturation": 0.0 if saturation is None else saturation,
        "sets": plan.sets,
        "couplings": [_coupling(one) for one in plan.couplings],
        "sigmas": _SIGMAS,
        "level": round(_level(d), 6),
        "report": _report(plan),
        "remarks": list(remarks),
    }


def _level(dimension: int) -> float:
    """Return the probability that a place is within its disc."""
    if dimension == 2:
        return 1.0 - math.exp(-0.5 * _SIGMAS**2)
    inside = math.erf(_SIGMAS / math.sqrt(2.0))
    return inside - math.sqrt(2.0 / math.pi) * _SIGMAS * math.exp(-0.5 * _SIGMAS**2)


def _track(vehicle: Vehicle, part: Trajectory, per_step: int, rounding: Rounding) -> TrackView:
    """Return one vehicle's path, discs and speeds."""
    axes, velocity = list(vehicle.system.position), vehicle.system.velocity
    speeds = np.zeros(len(part.means))
    if velocity is not None:
        speeds = np.linalg.norm(part.means[:, list(velocity)], axis=1)
    return {
        "name": part.name,
        "path": rounding.points(mean_path(vehicle, part, per_step)),
        "ellipses": ellipses_of(part.covariances[:, axes][:, :, axes]),
        "speed": [float(f"{speed:.3g}") for speed in speeds],
    }


def mean_path(vehicle: Vehicle, part: Trajectory, per_step: int) -> Matrix:
    """Return means at parts of every step, and at the end, (T p + 1, d) [m].

    Parameters
    ----------
    vehicle : Vehicle
        Whose dynamics.
    part : Trajectory
        Its means and controls.
    per_step : int
        Parts p of a step.
    """
    means = part.means[:, list(vehicle.system.position)]
    share = (np.arange(per_step) / per_step)[None, :, None]
    before, after = means[:-1, None], means[1:, None]
    hanging = (part.controls @ vehicle.system.sagitta.T)[:, None]
    between = before + share * (after - before) - 4.0 * share * (1.0 - share) * hanging
    return np.vstack([between.reshape(-1, means.shape[1]), means[-1:]])


def _ledger(plan: Plan, rounding: Rounding) -> list[LedgerLine]:
    """Return where the risk goes, the largest parts first, each with its place."""
    least = _NOTHING * plan.risk.bound
    rows = sorted((row for row in plan.risk.ledger if row.risk > least), key=lambda row: -row.risk)
    places = {
        vehicle.name: part.means[:, list(vehicle.system.position)]
        for vehicle, part in zip(plan.scenario.vehicles, plan.trajectories, strict=False)
    }
    return [_line(row, places, rounding) for row in rows[:_MOST_LINES]]


def _line(row: LedgerRow, places: dict[str, Matrix], rounding: Rounding) -> LedgerLine:
    """Return a line of the ledger; what is far from a vehicle has no partner."""
    here = places[row.vehicle]
    step = min(row.step, len(here) - 1)
    at = here[step]
    if row.cause in {"pair", "range"} and row.other in places:
        at = 0.5 * (at + places[row.other][step])
    return {
        "cause": row.cause,
        "vehicle": row.vehicle,
        "other": row.other,
        "step": row.step,
        "risk": float(f"{row.risk:.4g}"),
        "at": rounding.point(at),
    }


def _coupling(coupling: Coupling) -> CouplingView:
    """Return why two vehicles are planned together."""
    return {
        "vehicle": coupling.vehicle,
        "other": coupling.other,
        "text": coupling.sentence,
    }


def _report(plan: Plan) -> list[str]:
    """Return sentences about a plan: status, certificate, saturation, reasons."""
    said = [for_page(plan.status_sentence)]
    certified, saturation = plan.risk.certified, plan.risk.saturation
    if certified is not None:
        relation = "within" if certified <= plan.risk.bound else "above"
        risk, bound = bound_texts(certified, plan.risk.bound)
        said.append(f"risk of any collision at most {risk}, {relation} the risk bound {bound}")
    if saturation is not None and saturation >= _TOLD:
        said.append(f"some control saturates with a probability of at most {saturation:.2g}")
    if plan.risk.price:
        saved = 0.01 * plan.risk.bound * plan.risk.price
        said.append(f"1 % more of the risk bound would save about {saved:.2g} of the cost")
    if plan.explanation:
        said.append(for_page(plan.explanation))
    return said
