"""From vehicles and what they avoid to a program, and from a solution back to controls.

Columns: per vehicle ``u⁺`` step by step, then ``u⁻``,
so that ``u = u⁺ − u⁻`` and, at no extra row, ``|u| <= u⁺ + u⁻``.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.program.builder import ProgramBuilder
from radmpc.program.keepout import KeepOut, obstacle_keepouts
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.subject import Response, Subject, make_subject
from radmpc.program.turned import Turned

__all__ = ["build_program", "controls_of", "responses", "whole_subjects"]


def responses(scenario: Scenario) -> tuple[Response, ...]:
    """Return every vehicle's response, computed once per distinct system."""
    known: dict[int, Response] = {}
    for vehicle in scenario.vehicles:
        if id(vehicle.system) not in known:
            known[id(vehicle.system)] = Response.of(vehicle.system, scenario.horizon)
    return tuple(known[id(vehicle.system)] for vehicle in scenario.vehicles)


def whole_subjects(scenario: Scenario) -> tuple[Subject, ...]:
    """Return every vehicle from its start over the whole horizon."""
    subjects = []
    for vehicle, response in zip(scenario.vehicles, responses(scenario), strict=True):
        covariances = vehicle.covariances(scenario.horizon)
        bounds = vehicle.control_bounds(covariances)
        subjects.append(make_subject(vehicle, response, vehicle.start, covariances, bounds))
    return tuple(subjects)


def build_program(
    scenario: Scenario,
    subjects: Sequence[Subject],
    *,
    risk_bound: float,
    first_step: int = 0,
    temporal: Sequence[KeepOut] = (),
    turned: Turned | None = None,
) -> DisjunctiveProgram:
    """Build the program of some vehicles (paper, Eqs. 1-3, 7, 8 and section Avoidance).

    Parameters
    ----------
    scenario : Scenario
        Obstacles, workspace, and what counts as a collision.
    subjects : sequence of Subject
        The vehicles planned together; all their pairs are kept apart.
    risk_bound : float
        Δ for these vehicles.
    first_step : int
        Absolute step at which the subjects start.
    temporal : sequence of KeepOut
        Other vehicles' temporal obstacles; booked as pairs.
    turned : Turned or None
        Paths of the subjects that half-spaces are turned to: one for every window in place of the
        faces of obstacles and pairs.

    Returns
    -------
    DisjunctiveProgram
        Risk present at the first step charged where it is k = 0.
    """
    builder = ProgramBuilder(scenario, tuple(subjects), first_step, turned)
    horizon = subjects[0].horizon
    intervals = scenario.avoidance == "intervals"
    still: list[KeepOut] = []
    for obstacle in scenario.obstacles:
        keepouts = obstacle_keepouts(obstacle, first_step, horizon, intervals=intervals)
        still += keepouts
    for i in range(len(subjects)):
        for keepout in still:
            builder.keep_out(i, "obstacle", keepout)
        for keepout in temporal:
            builder.keep_out(i, "pair", keepout)
        builder.keep_in_workspace(i)
    for i, j in combinations(range(len(subjects)), 2):
        builder.keep_apart(i, j)
    return builder.finish(risk_bound)


def controls_of(subjects: Sequence[Subject], z: Vector) -> list[Matrix]:
    """Return the nominal controls of each vehicle, (T, m), from a program's solution."""
    controls, start = [], 0
    for subject in subjects:
        span = subject.control_bounds.size
        plus, minus = z[start : start + span], z[start + span : start + 2 * span]
        controls.append((plus - minus).reshape(subject.control_bounds.shape))
        start += 2 * span
    return controls
