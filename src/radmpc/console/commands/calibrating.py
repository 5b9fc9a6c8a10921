"""Noise from a plan's own missions in a simulator, and a plan that knows it."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from rich.table import Table
from rich.text import Text

from radmpc.console.files import check_output, check_separate, writing
from radmpc.console.loading import read_plan
from radmpc.console.output import note, show, show_json
from radmpc.console.reports.noise import noise_report
from radmpc.console.reports.noise_values import identification_json, plain_array
from radmpc.console.reports.progress import progress_line
from radmpc.console.reports.report import facts
from radmpc.console.running.guard import Code
from radmpc.errors import ArgumentError, FileFormatError, ScenarioError
from radmpc.flying.backends import Backend, backend_named
from radmpc.io.native.plan_file import save_plan
from radmpc.io.native.scenario_file import save_scenario
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planning import plan as make_plan
from radmpc.records import dataclass
from radmpc.referee import certify
from radmpc.simulators.calibration.calibrate import Calibration, calibrate
from radmpc.simulators.calibration.missions import Making, Rate, flown, rate_of

__all__ = ["CalibrateRequest", "run_calibrate"]


@dataclass(frozen=True, slots=True)
class CalibrateRequest:
    """What the command line asked for.

    Attributes
    ----------
    plan_file : Path
        The plan that is flown.
    backend : str
        What it is flown with.
    output : Path
        Where the scenario with the noise goes.
    plan_output : Path or None
        Where a plan of that scenario goes, which then is flown, too.
    missions : int
        How often each is flown.
    seed : int
        Of all noise and of planning.
    options : tuple of str
        For the backend, as typed: ``KEY=VALUE``.
    as_json : bool
        Whether stdout gets JSON rather than a report.
    """

    plan_file: Path
    backend: str
    output: Path
    plan_output: Path | None = None
    missions: int = 20
    seed: int = 0
    options: tuple[str, ...] = ()
    as_json: bool = False


@dataclass(frozen=True, slots=True)
class _Flown:
    """A plan, and what became of it."""

    bound: float
    certified: float
    rate: Rate

    @property
    def holds(self) -> bool:
        """Whether what was flown does not contradict the certificate."""
        return self.rate.low <= self.certified


def run_calibrate(request: CalibrateRequest) -> int:
    """Fly, identify, write; with a place for a plan, plan and fly again.

    Parameters
    ----------
    request : CalibrateRequest
        What was typed.

    Returns
    -------
    int
        The exit code: 1 if there is no new plan, or it collides more often than it may.

    Raises
    ------
    ArgumentError
        If an option is spelled another way, or the backend is none.
    FileFormatError, OutputError, NoPlanError
        If the plan cannot be read or flown, or something not be written.
    ScenarioError
        If the backend does not take the plan's scenario.
    """
    _check(request)
    plan, making = read_plan(request.plan_file), _making(request)
    day = datetime.now(tz=UTC).strftime("%Y-%m-%d")
    with progress_line(is_shown=not request.as_json) as line:
        try:
            found = calibrate(
                plan,
                making,
                missions=request.missions,
                seed=request.seed,
                day=day,
                progress=lambda done: line("flying", done, request.missions),
            )
        except ScenarioError as error:
            raise ScenarioError(f"{request.plan_file}: {error}") from error
    before = _Flown(plan.scenario.risk_bound, certify(plan).certified, found.rate)
    with writing(request.output):
        save_scenario(found.scenario, request.output)
    after = _planned(request, found, making)
    if request.as_json:
        show_json(_record(request, found, before, after))
    else:
        show(*_report(request, found, before, after))
    return Code.OK if request.plan_output is None else _judged(after)


def _judged(after: _Flown | str | None) -> Code:
    """Say on stderr what speaks against the new plan, and return the exit code."""
    if not isinstance(after, _Flown):
        note("no certified plan with that noise")
        return Code.NO
    if not after.holds:
        note("the new plan collides more often than its certificate allows")
        return Code.NO
    return Code.OK


def _check(request: CalibrateRequest) -> None:
    """Refuse what would fail only after the work is done."""
    for path in (request.output, request.plan_output):
        check_output(path)
    check_separate(request.plan_file, request.output, request.plan_output)
    if request.output.suffix not in {".yaml", ".yml", ".json"}:
        raise FileFormatError(f"{request.output}: scenarios are written as .yaml or .json")


def _making(request: CalibrateRequest) -> Making:
    """Return what makes the backend."""
    kind, options = backend_named(request.backend), _options(request.options)
    kind.check_options(options)

    def making(scenario: Scenario, rng: np.random.Generator) -> Backend:
        return kind.make(scenario, rng=rng, **options)

    return making


def _options(typed: tuple[str, ...]) -> dict[str, str]:
    """Return options for a backend by their names."""
    found: dict[str, str] = {}
    for word in typed:
        name, equals, value = (part.strip() for part in word.partition("="))
        if not (equals and name.isidentifier() and value) or name in found:
            raise ArgumentError(f"--option must be KEY=VALUE, every key once, got {word!r}")
        found[name] = value
    return found


def _planned(request: CalibrateRequest, found: Calibration, making: Making) -> _Flown | str | None:
    """Plan with the noise that was found, write the plan, and fly it; or say why there is none."""
    if request.plan_output is None:
        return None
    result = make_plan(found.scenario, rng=request.seed)
    if not result.is_certified:
        return result.explanation or result.record.status_sentence
    plan: Plan = result.require()
    with writing(request.plan_output):
        save_plan(plan, request.plan_output)
    with progress_line(is_shown=not request.as_json) as line:
        missions = flown(
            plan,
            making,
            request.missions,
            request.seed + 1,
            lambda done: line("flying again", done, request.missions),
        )
    rate = rate_of(plan.scenario, missions)
    return _Flown(plan.scenario.risk_bound, certify(plan).certified, rate)


def _report(
    request: CalibrateRequest, found: Calibration, before: _Flown, after: _Flown | str | None
) -> list[Table | Text]:
    """Return what was found as parts to show."""
    ratios = ", ".join(f"{cover.ratio:.2f}" for cover in found.covers)
    rows: dict[str, Text | str] = {
        "flown with": request.backend,
        "as planned": _sentence(before),
        "covering": f"variances multiplied by {ratios}, for deviations as large as flown",
        "feedback": _loops_sentence(found),
        "scenario": f"written to {request.output}",
    }
    if isinstance(after, _Flown):
        rows["planned anew"] = _sentence(after)
        rows["plan"] = f"written to {request.plan_output}"
    elif after is not None:
        rows["planned anew"] = Text(f"no certified plan with that noise: {after}", style="yellow")
    return [*noise_report(found.identification), Text(), facts(rows)]


def _loops_sentence(found: Calibration) -> str:
    """Return whether feedback did what it should."""
    if not found.loops:
        return "cannot be told"
    worst = max(found.loops, key=lambda loop: loop.score)
    if not worst.differs:
        return "as planned, within what chance makes of it"
    return (
        f"of {worst.vehicle!r} not as planned, by {worst.score:.1f} deviations: covered as if noise"
    )


def _sentence(flight: _Flown) -> Text:
    """Return what became of a plan."""
    rate = flight.rate
    holds = "" if flight.holds else ": more than the certificate allows"
    return Text(
        f"{rate.collided} of {rate.missions} missions collided, {rate.rate:.3g} "
        f"[{rate.low:.2g}, {rate.high:.2g}]; certified {flight.certified:.3g}{holds}; disturbances "
        f"spoke against the model in {rate.doubted}",
        style="" if flight.holds else "yellow",
    )


def _record(
    request: CalibrateRequest, found: Calibration, before: _Flown, after: _Flown | str | None
) -> dict[str, object]:
    """Return what was found as plain values."""
    vehicles = found.scenario.vehicles
    return {
        "backend": request.backend,
        "missions": request.missions,
        "before": _plain(before),
        "identified": identification_json(found.identification),
        "covers": [
            {
                "vehicles": [vehicles[i].name for i in cover.vehicles],
                "covariance": cover.covariance.tolist(),
                "drift": None if cover.drift is None else cover.drift.tolist(),
                "autocorrelation": cover.color,
                "ratio": cover.ratio,
            }
            for cover in found.covers
        ],
        "loops": [
            {
                "vehicle": loop.vehicle,
                "planned": loop.planned.tolist(),
                "flown": loop.flown.value.tolist(),
                "low": plain_array(loop.flown.low),
                "high": plain_array(loop.flown.high),
                "differs": loop.differs,
            }
            for loop in found.loops
        ],
        "scenario": str(request.output),
        "plan": str(request.plan_output) if isinstance(after, _Flown) else None,
        "after": _plain(after) if isinstance(after, _Flown) else None,
        "problem": after if isinstance(after, str) else None,
    }


def _plain(flight: _Flown) -> dict[str, object]:
    """Return what became of a plan as plain values."""
    rate = flight.rate
    return {
        "bound": flight.bound,
        "certified": flight.certified,
        "rate": rate.rate,
        "rate_low": rate.low,
        "rate_high": rate.high,
        "collided": rate.collided,
        "doubted": rate.doubted,
        "holds": flight.holds,
    }
