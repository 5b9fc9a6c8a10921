"""From vehicles and what they avoid to a program, and from its solution back to controls.

Columns: per vehicle ``u⁺`` step by step, then ``u⁻``,
so that ``u = u⁺ − u⁻`` and, at no extra row, ``|u| <= u⁺ + u⁻``. The times of visits follow where
they are needed (`radmpc.program.visits`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.noise.positions import position_response
from radmpc.model.relations.alike import covariances_of_all
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.program.builder import ProgramBuilder
from radmpc.program.condensed import CondensedModel, PredictionMatrices, condense
from radmpc.program.keepout import KeepOut, KeepOuts, obstacle_keepouts
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.sharing.contribution import Contribution
from radmpc.records import replace

__all__ = [
    "SharedBlocks",
    "build_program",
    "condensed_models",
    "controls_of",
    "cost_of_time",
    "point_of",
    "prediction_matrices",
]


def prediction_matrices(scenario: Scenario) -> tuple[PredictionMatrices, ...]:
    """Return every vehicle's prediction matrices, computed once per distinct system."""
    known: dict[tuple[object, ...], PredictionMatrices] = {}
    found = []
    for system in (vehicle.system for vehicle in scenario.vehicles):
        # Of a scenario file every vehicle has a system of its own, the same as others'.
        key = system.A.tobytes(), system.B.tobytes(), system.position, system.velocity
        if key not in known:
            known[key] = PredictionMatrices.of(system, scenario.horizon)
        found.append(known[key])
    return tuple(found)


def condensed_models(scenario: Scenario) -> tuple[CondensedModel, ...]:
    """Return every vehicle condensed over the whole horizon, from its start."""
    models, vehicles = [], scenario.vehicles
    spreads = covariances_of_all(vehicles, scenario.horizon)
    every = zip(vehicles, prediction_matrices(scenario), spreads, strict=True)
    for vehicle, prediction, covariances in every:
        bounds = vehicle.control_bounds(covariances)
        common = None
        if vehicle.shared:
            noise, gain = vehicle.noise, vehicle.gain
            common = position_response(vehicle.system, noise, gain, scenario.horizon)
        model = condense(vehicle, prediction, vehicle.start, covariances, bounds, common=common)
        if scenario.time_weight > 0.0 and vehicle.goal.within is not None:
            model = replace(model, time_cost=scenario.time_weight * scenario.dt * scenario.horizon)
        models.append(model)
    return tuple(models)


def build_program(
    scenario: Scenario,
    models: Sequence[CondensedModel],
    *,
    risk_bound: float,
    first_step: int = 0,
    temporal: Sequence[KeepOut] = (),
    shared: SharedBlocks | None = None,
) -> DisjunctiveProgram:
    """Build the program of some vehicles (paper, Eqs. 1-3, 7, 8 and section Avoidance).

    Parameters
    ----------
    scenario : Scenario
        Obstacles, workspace, and what counts as a collision.
    models : sequence of CondensedModel
        The vehicles planned together; all their pairs are kept apart.
    risk_bound : float
        Δ for these vehicles.
    first_step : int
        Absolute step at which the program starts.
    temporal : sequence of KeepOut
        Other vehicles' temporal obstacles; charged as pairs.
    shared : SharedBlocks or None
        Rows of other sets of the same fleet, of programs from step 0 on without any of these.

    Returns
    -------
    DisjunctiveProgram
        Risk present at the first step charged where it is k = 0.
    """
    builder = ProgramBuilder(scenario, tuple(models), first_step)
    if shared is None or first_step > 0 or temporal:
        of_obstacles = _of_obstacles(scenario, first_step, models[0].horizon)
        for i in range(len(models)):
            _avoid_alone(builder, i, of_obstacles, temporal)
        for i, j in combinations(range(len(models)), 2):
            builder.keep_apart(i, j)
    else:
        shared.add_to(builder)
    if scenario.keep:
        from radmpc.model.relations.keep import keep_pairs  # noqa: PLC0415 - few keep a range

        for i, j, within in keep_pairs(scenario.keep, [model.vehicle.name for model in models]):
            builder.keep_within(i, j, within)
    return builder.finish(risk_bound)


def _of_obstacles(scenario: Scenario, first_step: int, horizon: int) -> list[KeepOut]:
    """Return the keep-outs of all obstacles."""
    intervals = scenario.avoidance == "intervals"
    return [
        keepout
        for obstacle in scenario.obstacles
        for keepout in obstacle_keepouts(obstacle, first_step, horizon, intervals=intervals)
    ]


def _avoid_alone(
    builder: ProgramBuilder, i: int, of_obstacles: list[KeepOut], temporal: Sequence[KeepOut] = ()
) -> None:
    """Add what a vehicle avoids, whoever else is there."""
    name = builder.models[i].vehicle.name
    mine = {obstacle.name for obstacle in met_by(builder.scenario.obstacles, name)}
    builder.keep_out(i, "obstacle", [k for k in of_obstacles if k.name in mine])
    builder.keep_out(i, "pair", temporal)
    builder.keep_in_workspace(i)


class SharedBlocks:
    """Rows that programs of several sets of a fleet have in common, made once.

    A vehicle avoids the same obstacles in every set, and a pair keeps apart alike: only where they
    are among the outputs differs from set to set.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[str, ...], Contribution] = {}
        self._keepouts = KeepOuts()

    def add_to(self, builder: ProgramBuilder) -> None:
        """Add what vehicles avoid to the program of a set.

        Parameters
        ----------
        builder : ProgramBuilder
            Without rows; from step 0 on. Names tell vehicles apart; obstacles that a vehicle cannot
            meet may be missing in the scenarios of its other sets.
        """
        everyone = range(len(builder.models))
        if len(everyone) == 1:
            self._known[_names_of(builder.models)] = self._made(builder)
            return
        for places in (*((i,) for i in everyone), *combinations(everyone, 2)):
            self._of(builder, places).add_to(builder, places)

    def clear(self) -> None:
        """Give up all rows, to be made anew."""
        self._known.clear()
        self._keepouts = KeepOuts()

    def _of(self, builder: ProgramBuilder, places: tuple[int, ...]) -> Contribution:
        """Return what a vehicle or a pair contributes, made where it is not known."""
        models = tuple(builder.models[i] for i in places)
        names = _names_of(models)
        if names not in self._known:
            self._known[names] = self._made(ProgramBuilder(builder.scenario, models, 0))
        return self._known[names]

    def _made(self, builder: ProgramBuilder) -> Contribution:
        """Return what one vehicle or one pair contributes, collected by a builder of these."""
        if len(builder.models) == 2:
            builder.keep_apart(0, 1)
            return Contribution.of(builder)
        scenario, horizon = builder.scenario, builder.models[0].horizon
        found = self._keepouts.of(scenario.obstacles, horizon, intervals=builder.intervals)
        _avoid_alone(builder, 0, list(found))
        return Contribution.of(builder)


def _names_of(models: Sequence[CondensedModel]) -> tuple[str, ...]:
    """Return the names of vehicles, by which rows of theirs are known."""
    return tuple(model.vehicle.name for model in models)


def controls_of(models: Sequence[CondensedModel], z: Vector) -> list[Matrix]:
    """Return the nominal controls of each vehicle from a program's solution.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of the program.
    z : (n,) array
        Its solution.

    Returns
    -------
    list of (T, m) array
        ``u⁺ − u⁻`` of each vehicle.
    """
    controls, start = [], 0
    for model in models:
        span = model.control_bounds.size
        up, down = z[start : start + span], z[start + span : start + 2 * span]
        # Solvers keep bounds up to a tolerance. What a half is below 0 counts, up to the limit of
        # its control: rows hold with it, and over long steps its effect is not small.
        most = np.abs(np.maximum(up, 0.0) - np.maximum(down, 0.0))
        most = np.maximum(model.control_bounds.ravel(), most)
        controls.append(np.clip(up - down, -most, most).reshape(model.control_bounds.shape))
        start += 2 * span
    return controls


def point_of(models: Sequence[CondensedModel], controls: Sequence[Matrix]) -> Vector:
    """Return the decision variables of vehicles' controls, the least that stand for them.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of the program.
    controls : sequence of (T, m) array
        Nominal controls of each vehicle of a program, in its order.

    Returns
    -------
    (n,) array
        ``u⁺`` and then ``u⁻`` of each vehicle; then the times of visits, if any need one.
    """
    halves = [(np.maximum(u, 0.0).ravel(), np.maximum(-u, 0.0).ravel()) for u in controls]
    parts = [half for pair in halves for half in pair]
    if any(model.vehicle.via or model.time_cost for model in models):
        from radmpc.program.visits.steps import times_of  # noqa: PLC0415 - few visit anything

        parts.append(times_of(models, controls))
    return np.concatenate(parts)


def cost_of_time(model: CondensedModel, controls: Matrix) -> float:
    """Return what the time until a vehicle's arrival costs.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.

    Returns
    -------
    float
        0 where its arrival is not free.
    """
    if model.time_cost == 0.0:
        return 0.0
    from radmpc.program.visits.steps import arrival_step  # noqa: PLC0415 - few pay for time

    return model.time_cost * arrival_step(model, controls) / model.horizon
