"""Plan files: ``format: radmpc/plan/1``, JSON."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from radmpc.arguments import check_path
from radmpc.arrays import as_array, as_matrix
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.native.checking import check_format, validated
from radmpc.io.native.decoding import check_entries, decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.ranges import PLAN_FORMAT, SCENARIO_FORMAT
from radmpc.io.text.document import SCENARIO_LINE, Document
from radmpc.io.text.files import one_line, read_text
from radmpc.io.text.json_text import read_json, write_json
from radmpc.model.given import check_plan
from radmpc.model.plan import Coupling, FirstPlan, LedgerRow, Plan, Risk, Status, Trajectory
from radmpc.system.atomic import write_text

if TYPE_CHECKING:
    from radmpc.io.native.plan_schema import RiskSpec, TrajectorySpec

__all__ = ["NotPlannedError", "decode_plan", "encode_plan", "load_plan", "save_plan"]


class NotPlannedError(FileFormatError):
    """A scenario's file where a plan's is wanted."""


def load_plan(path: str | os.PathLike[str]) -> Plan:
    """Return the plan in a file.

    Whether its arrays and names fit its scenario is not checked here: the referee names what
    does not.

    Parameters
    ----------
    path : path
        JSON.

    Returns
    -------
    Plan
        Equal to the one saved, bit for bit.

    Raises
    ------
    FileFormatError
        With one line that names file, line, field, value and what is allowed.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> with TemporaryDirectory() as folder:
    ...     radmpc.save_plan(plan, Path(folder) / "a.json")
    ...     read = radmpc.load_plan(Path(folder) / "a.json")
    >>> read.status is plan.status, [t.name for t in read.trajectories]
    (True, ['v1', 'v2'])
    """
    check_path(path)
    name, text = os.fspath(path), read_text(path)
    not_planned = NotPlannedError(one_line(f"{name}: is a scenario, not a plan: plan it first"))
    try:
        document = Document(name, text, read_json(text, name), None)
    except FileFormatError as error:
        if SCENARIO_LINE.search(text):
            raise not_planned from error
        raise
    if _is_scenario(document.value):
        raise not_planned
    try:
        return decode_plan(document.value)
    except ScenarioError as error:
        raise document.failure(error) from error


def _is_scenario(value: object) -> bool:
    """Whether a file's content is a scenario, and no plan whose format was mistyped."""
    if not isinstance(value, Mapping) or "scenario" in value:
        return False
    return value.get("format") == SCENARIO_FORMAT


def save_plan(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a plan to a file as JSON, whole or not at all; it reads back equal.

    Parameters
    ----------
    plan : Plan
        What to write, also where no plan was found.
    path : path
        The file; an existing one is replaced.

    Raises
    ------
    FileFormatError
        If a number in the plan is not finite.
    ArgumentTypeError
        If an argument is of another kind; the message says what to do instead.
    ScenarioError
        If the scenario holds what no file can, see `encode_scenario`.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> with TemporaryDirectory() as folder:
    ...     radmpc.save_plan(plan, Path(folder) / "fleet.plan.json")
    ...     radmpc.load_plan(Path(folder) / "fleet.plan.json").cost == plan.cost
    True
    """
    check_plan(plan)
    check_path(path)
    write_text(path, write_json(encode_plan(plan)))


def encode_plan(plan: Plan, *, with_vehicles: bool = True) -> dict[str, object]:
    """Return the content of a plan file: dict, list, str, int, float, bool and None.

    Parameters
    ----------
    plan : Plan
        What to write.
    with_vehicles : bool
        Whether to include the trajectories, by far the largest part.

    Returns
    -------
    dict
        In the order of the format's description.

    Raises
    ------
    ScenarioError
        If the scenario holds what no file can, see `encode_scenario`.
    """
    content: dict[str, object] = {
        "format": PLAN_FORMAT,
        "scenario": encode_scenario(plan.scenario),
        "planner": plan.planner,
        "seed": None if plan.seed is None else int(plan.seed),
        "status": plan.status.value,
        "cost": _optional(plan.cost),
        "lower_bound": _optional(plan.lower_bound),
        "certified_lower_bound": _optional(plan.certified_lower_bound),
        "risk": {
            "bound": float(plan.risk.bound),
            "certified": _optional(plan.risk.certified),
            "ledger": [_ledger_row(row) for row in plan.risk.ledger],
            **({} if plan.risk.price is None else {"price": float(plan.risk.price)}),
            **_saturation(plan),
        },
        "sets": [list(names) for names in plan.sets],
        "couplings": [_coupling(coupling) for coupling in plan.couplings],
        "seconds": {stage: float(seconds) for stage, seconds in plan.seconds.items()},
        "versions": dict(plan.versions),
        "explanation": plan.explanation,
        "stopped_by": plan.stopped_by,
        **_first(plan),
    }
    if with_vehicles:
        content["vehicles"] = [_vehicle(trajectory) for trajectory in plan.trajectories]
    return content


def _optional(value: float | None) -> float | None:
    """Return a plain float, or None."""
    return None if value is None else float(value)


def _first(plan: Plan) -> dict[str, object]:
    """Return when the first certified plan was there, if it is known."""
    if plan.first is None:
        return {}
    first = {"seconds": float(plan.first.seconds), "cost": float(plan.first.cost)}
    return {"first_plan": first}


def _saturation(plan: Plan) -> dict[str, object]:
    """Return the bound on saturation, where there is one."""
    saturation = plan.risk.saturation
    return {} if saturation is None else {"saturation": float(saturation)}


def _ledger_row(row: LedgerRow) -> dict[str, object]:
    """Return a row of the ledger."""
    return {
        "cause": row.cause,
        "vehicle": row.vehicle,
        "other": row.other,
        "step": int(row.step),
        "risk": float(row.risk),
    }


def _coupling(coupling: Coupling) -> dict[str, object]:
    """Return an edge of the coupling graph."""
    return {
        "vehicle": coupling.vehicle,
        "other": coupling.other,
        "reason": coupling.reason,
        "value": _optional(coupling.value),
    }


def _vehicle(trajectory: Trajectory) -> dict[str, object]:
    """Return a vehicle's part."""
    return {
        "name": trajectory.name,
        "controls": trajectory.controls.tolist(),
        "means": trajectory.means.tolist(),
        "covariances": trajectory.covariances.tolist(),
        "gain": None if trajectory.gain is None else trajectory.gain.tolist(),
    }


def decode_plan(data: object) -> Plan:
    """Return the plan that plain data describe.

    Parameters
    ----------
    data : mapping
        The content of a plan file.

    Returns
    -------
    Plan
        Its types checked; its arrays not yet compared with its scenario.

    Raises
    ------
    ScenarioError
        If anything is missing, unknown or not allowed; its path says where in the data.
    """
    from radmpc.io.native.plan_schema import PlanSpec  # noqa: PLC0415 - saving needs none

    content = check_format(data, PLAN_FORMAT)
    scenario = content.get("scenario")
    try:
        check_entries(scenario if isinstance(scenario, Mapping) else {})
    except ScenarioError as error:
        raise error.under("scenario") from error
    spec = validated(PlanSpec, content)
    try:
        scenario = decode_scenario(spec.scenario)
    except ScenarioError as error:
        raise error.under("scenario") from error
    return Plan(
        scenario=scenario,
        planner=spec.planner,
        seed=spec.seed,
        status=Status(spec.status),
        cost=spec.cost,
        lower_bound=spec.lower_bound,
        certified_lower_bound=spec.certified_lower_bound,
        risk=_risk(spec.risk),
        sets=tuple(tuple(names) for names in spec.sets),
        seconds=dict(spec.seconds),
        versions=dict(spec.versions),
        explanation=spec.explanation,
        stopped_by=spec.stopped_by,
        first=None if spec.first_plan is None else FirstPlan(**spec.first_plan.model_dump()),
        trajectories=tuple(_trajectory(i, entry) for i, entry in enumerate(spec.vehicles)),
        couplings=tuple(Coupling(c.vehicle, c.other, c.reason, c.value) for c in spec.couplings),
    )


def _risk(spec: RiskSpec) -> Risk:
    """Return the risk bound, and what is charged against it."""
    ledger = tuple(
        LedgerRow(row.cause, row.vehicle, row.other, row.step, row.risk) for row in spec.ledger
    )
    return Risk(spec.bound, spec.certified, ledger, spec.price, spec.saturation)


def _trajectory(index: int, spec: TrajectorySpec) -> Trajectory:
    """Return a vehicle's part."""
    try:
        return Trajectory(
            name=spec.name,
            controls=as_matrix(spec.controls, path=("controls",)),
            means=as_matrix(spec.means, path=("means",)),
            covariances=as_array(spec.covariances, (None, None, None), ("covariances",)),
            gain=None if spec.gain is None else as_matrix(spec.gain, path=("gain",)),
        )
    except ScenarioError as error:
        raise error.under("vehicles", index) from error
