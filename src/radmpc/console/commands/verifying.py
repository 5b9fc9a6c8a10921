"""A plan certified and simulated anew, as one record and as a report."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table
from rich.text import Text

from radmpc.console.loading import read_plan
from radmpc.console.output import note, show, show_json
from radmpc.console.reports.progress import progress_line
from radmpc.console.reports.report import facts, verdict
from radmpc.console.reports.saturating import saturation_line, saturation_warning
from radmpc.console.running.guard import Code
from radmpc.console.words import first_of, scenario_line
from radmpc.errors import ScenarioError
from radmpc.io.flight.flight_file import is_flight
from radmpc.model.ledger import bound_text, bound_texts
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Avoidance, Scenario
from radmpc.records import asdict, dataclass, replace
from radmpc.referee import Certificate, Simulation, certify, simulate
from radmpc.referee.simulation.simulation import check_samples

__all__ = ["Verification", "run_verify", "verify_plan", "verify_report"]


@dataclass(frozen=True, slots=True)
class Verification:
    """What certificate and simulation say; its fields are the JSON's keys.

    Attributes
    ----------
    holds : bool
        Whether the plan is what it claims and within its bound.
    bound : float
        The scenario's Δ.
    certified : float or None
        Upper bound on the joint collision probability; None without a plan.
    rate, rate_low, rate_high : float or None
        Simulated collision rate and its confidence interval.
    samples : int
        Simulated samples of the mission.
    problems : tuple of str
        What does not hold.
    saturation_bound : float or None
        Upper bound on the probability that feedback ever asks for more control than there is.
    saturation_rate : float or None
        Share of samples in which it does, and is cut off.
    warnings : tuple of str
        What the certificate does not speak of.
    """

    holds: bool
    bound: float
    certified: float | None
    rate: float | None
    rate_low: float | None
    rate_high: float | None
    samples: int
    problems: tuple[str, ...]
    saturation_bound: float | None = None
    saturation_rate: float | None = None
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return plain values."""
        return asdict(self)


def run_verify(path: Path, samples: int, seed: int, avoidance: str | None, *, as_json: bool) -> int:
    """Judge the plan in a file and report.

    Parameters
    ----------
    path : Path
        The plan; or a flight, which is recomputed.
    samples : int
        Samples to simulate.
    seed : int
        Of the simulation.
    avoidance : str or None
        As typed; None is as in the plan's scenario.
    as_json : bool
        Whether stdout gets JSON rather than the report.

    Returns
    -------
    int
        The exit code: whether the plan holds.

    Raises
    ------
    ScenarioError
        If there is no such avoidance.
    ArgumentError
        If the samples are none, or too many.
    """
    where: Avoidance | None = None
    if avoidance is not None:
        if avoidance not in {"intervals", "steps"}:
            raise ScenarioError(f"--avoidance must be 'intervals' or 'steps', got {avoidance!r}")
        where = "steps" if avoidance == "steps" else "intervals"
    if is_flight(path):
        return _verify_flight(path, where, as_json=as_json)
    check_samples(samples)  # before the certificate, which may take long
    record = read_plan(path)
    verification = verify_plan(record, samples, seed, where)
    if as_json:
        show_json(verification.as_json())
    else:
        show(*verify_report(record.scenario, verification, where))
    if verification.holds:
        return Code.OK
    note(f"{path}: {_doubts(verification)}")
    return Code.NO


def _doubts(verification: Verification) -> str:
    """Return what stands against a plan that does not hold."""
    if verification.problems:
        told = first_of(verification.problems)
        return told if told.startswith("no plan") else f"the plan does not hold: {told}"
    certified, bound = bound_texts(verification.certified or 0.0, verification.bound)
    return f"the certificate {certified} exceeds the risk bound {bound}"


def _verify_flight(path: Path, where: Avoidance | None, *, as_json: bool) -> int:
    """Judge a flight, which counts collisions where its plan does."""
    from radmpc.console.commands.verifying_flight import (  # noqa: PLC0415 - plans need none of it
        run_verify_flight,
    )

    if where is not None:
        raise ScenarioError(f"--avoidance is for plans, and {path} is a flight")
    return run_verify_flight(path, as_json=as_json)


def verify_plan(
    plan: Plan, samples: int, seed: int, avoidance: Avoidance | None = None
) -> Verification:
    """Return the referee's word on a plan, and what a simulation adds to it.

    Parameters
    ----------
    plan : Plan
        As read from a file.
    samples : int
        Samples to simulate.
    seed : int
        Of the simulation.
    avoidance : {'intervals', 'steps'} or None
        Where collisions count; None is as in the plan's scenario.

    Returns
    -------
    Verification
        A plan without vehicles does not hold; its problem is the reason it gives.
    """
    bound = plan.scenario.risk_bound
    if not plan.trajectories:
        return Verification(False, bound, None, None, None, None, 0, _reasons(plan))
    certificate = certify(plan, avoidance=avoidance)
    try:
        with progress_line() as progress:
            simulation = simulate(
                plan,
                samples,
                rng=seed,
                avoidance=avoidance,
                progress=lambda done, total: progress("simulating", done, total),
            )
    except ScenarioError as error:
        # Arrays that do not fit the scenario cannot be flown: an answer, not bad usage.
        reasons = certificate.problems or (str(error),)
        certified, saturation = certificate.certified, certificate.saturation
        return Verification(False, bound, certified, None, None, None, 0, reasons, saturation)
    return _verification(plan, certificate, simulation)


def _verification(plan: Plan, certificate: Certificate, simulation: Simulation) -> Verification:
    """Return what both say, and whether one contradicts the other."""
    bound = plan.scenario.risk_bound
    problems = certificate.problems
    # An upper bound below a rate that is surely larger would be wrong: do not trust either.
    is_contradicted = simulation.rate_low > max(bound, certificate.certified)
    if is_contradicted:
        problems += (
            f"the simulated collision rate is at least {simulation.rate_low:.4g}, "
            f"above the certificate {bound_text(certificate.certified)}"
            f"; controls saturate in {100.0 * simulation.saturation_rate:.3g} % of samples",
        )
    warning = saturation_warning(plan, certificate.saturation)
    return Verification(
        holds=certificate.holds and not is_contradicted,
        bound=bound,
        certified=certificate.certified,
        rate=simulation.rate,
        rate_low=simulation.rate_low,
        rate_high=simulation.rate_high,
        samples=simulation.samples,
        problems=problems,
        saturation_bound=certificate.saturation,
        saturation_rate=simulation.saturation_rate,
        warnings=() if warning is None else (warning,),
    )


def _reasons(plan: Plan) -> tuple[str, ...]:
    """Return why a file holds no plan; one that says it does is wrong."""
    if plan.status in {Status.OPTIMAL, Status.FEASIBLE}:
        return certify(plan).problems
    return (f"no plan: {plan.explanation}" if plan.explanation else plan.status.sentence,)


def verify_report(
    scenario: Scenario, verification: Verification, avoidance: Avoidance | None = None
) -> list[Table | Text]:
    """Return the same as parts to show, under the scenario in which the plan was judged.

    Parameters
    ----------
    scenario : Scenario
        The plan's.
    verification : Verification
        What was found.
    avoidance : {'intervals', 'steps'} or None
        Where collisions count; None is as in the scenario.
    """
    judged = scenario if avoidance is None else replace(scenario, avoidance=avoidance)
    rows: dict[str, Text | str] = {
        "certificate": verdict(verification.certified, verification.bound)
    }
    if verification.rate is not None:
        hits = round(verification.rate * verification.samples)
        rows["simulated"] = (
            f"{hits} of {verification.samples} samples collide: {verification.rate:.4g} "
            f"({verification.rate_low:.4g} to {verification.rate_high:.4g} with 95 % confidence)"
        )
    if verification.saturation_bound is not None:
        rows["saturation"] = saturation_line(
            verification.saturation_bound,
            verification.saturation_rate,
            next(iter(verification.warnings), None),
            feeds_back=any(vehicle.gain is not None for vehicle in scenario.vehicles),
        )
    if verification.problems:
        rows["problems"] = Text("\n".join(verification.problems), style="red")
    word = Text("holds", "bold green") if verification.holds else Text("does not hold", "bold red")
    return [Text(scenario_line(judged), style="bold"), facts(rows | {"the plan": word})]
