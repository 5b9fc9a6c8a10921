"""A plan written for the vehicles' own tools, from the command line."""

from __future__ import annotations

from math import inf
from pathlib import Path

from radmpc.console.files import OutputError, check_output, writing
from radmpc.console.options import is_option, named_options
from radmpc.console.output import is_stdout, note, show
from radmpc.console.running.guard import Code
from radmpc.console.words import first_of
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.export.exporting import (
    ROUNDING,
    Exported,
    ExportOptions,
    export_plan,
    save_exported,
)
from radmpc.io.export.origin import parse_origin
from radmpc.io.text.files import one_line
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Plan
from radmpc.records import dataclass
from radmpc.referee import Certificate, Thinned, certify, thin
from radmpc.referee.claims.claims import shape_problems

__all__ = ["ExportRequest", "run_export"]

_OPTIONS = ("to", "origin", "altitude")

_ROUNDED = 1e-3
"""By how much positions of a format may be off where it does not say [m]."""


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """What the command line asked for.

    Attributes
    ----------
    plan_file : Path
        Where the plan was read; it is never written over.
    to : str
        The format.
    output : Path
        Where it goes.
    origin : str or None
        Place on earth of the plan's origin, as typed.
    altitude : float or None
        Height of a 2-D plan above the origin [m].
    tolerance : float or None
        How far legs of several steps may be from the plan [m]; None writes all steps.
    risk_bound : float or None
        Up to which steps are left out; None is the plan's own.
    """

    plan_file: Path
    to: str
    output: Path
    origin: str | None = None
    altitude: float | None = None
    tolerance: float | None = None
    risk_bound: float | None = None


def run_export(plan: Plan, request: ExportRequest) -> int:
    """Write a plan in another format; say where, and what the format loses.

    Parameters
    ----------
    plan : Plan
        As read from a file.
    request : ExportRequest
        What is asked for.

    Returns
    -------
    int
        The exit code: a plan that does not hold is written too, with a warning.
    """
    doubts = _doubts(certify(plan)) if plan.trajectories else ""
    thinned = _thinned(plan, request)
    exported = _exported(plan, request, thinned, is_certified=not doubts)
    _check_place(exported, request)
    for path in exported.files:
        check_output(path)
        if path.exists() and path.samefile(request.plan_file):
            raise OutputError(f"cannot write {path}: it is the plan itself")
    with writing(request.output):
        save_exported(exported)
    for path in exported.files:
        whose = exported.vehicles.get(path)
        of_whom = "" if whose is None else one_line(f" of {whose}")
        show(f"plan{of_whom} written to {path}")
    if thinned is not None and thinned.certificate.holds:
        show(thinned.note)
    elif thinned is not None and not doubts:
        note(f"warning: {thinned.note}")
    for warning in exported.warnings:
        note(f"warning: {warning}")
    if doubts:
        note(f"warning: {doubts}")
    return Code.OK


def _thinned(plan: Plan, request: ExportRequest) -> Thinned | None:
    """Return the steps that are written, None if that is all."""
    if request.tolerance is None:
        if request.risk_bound is not None:
            raise ScenarioError("--risk-bound needs --tolerance: it is for steps left out")
        return None
    if not 0.0 < request.tolerance < inf:
        raise ScenarioError(f"--tolerance must be a number > 0 m, got {request.tolerance:g}")
    if request.to == "csv":
        raise ScenarioError("--tolerance does not fit csv: its controls are for all steps")
    if shape_problems(plan):
        return None  # the export tells them
    rounding = ROUNDING.get(request.to, _ROUNDED)
    with named_options("risk_bound"):
        return thin(plan, request.tolerance, rounding=rounding, risk_bound=request.risk_bound)


def _exported(
    plan: Plan, request: ExportRequest, thinned: Thinned | None, *, is_certified: bool
) -> Exported:
    """Return what is to be written; what is wrong is an option, or in the plan's file."""
    with named_options(*_OPTIONS):
        origin = None if request.origin is None else parse_origin(request.origin)
        options = ExportOptions(
            origin,
            request.altitude,
            is_certified=is_certified,
            steps=None if thinned is None else thinned.steps,
            note=None if thinned is None else thinned.note,
        )
        try:
            return export_plan(plan, request.to, request.output, options)
        except ScenarioError as error:
            if is_option(error, _OPTIONS):
                raise
            raise FileFormatError(one_line(f"{request.plan_file}: {error}")) from error


def _check_place(exported: Exported, request: ExportRequest) -> None:
    """Refuse a file per vehicle where no files are: their names would stand beside a device."""
    path = request.output
    if not exported.vehicles or not path.exists() or path.is_dir():
        return
    if is_stdout(path) or not path.is_file():
        raise OutputError(
            f"cannot write {path}: {request.to} makes a file for each of "
            f"{len(exported.vehicles)} vehicles, and this is a stream or a device: name a file, "
            "as -o fleet.plan"
        )


def _doubts(certificate: Certificate) -> str:
    """Return what stands against using a plan, nothing if it holds."""
    if certificate.holds:
        return ""
    if certificate.problems:
        return f"the plan does not hold: {first_of(certificate.problems)}"
    risk, bound = bound_texts(certificate.certified, certificate.bound)
    return f"the plan is not certified within its risk bound {bound}: at most {risk}"
