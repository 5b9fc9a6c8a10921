"""A flight to and from plain data, the shapes of all arrays checked against the plan's scenario."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict

from radmpc.arrays import Matrix, Vector, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.io.flight.flight_schema import HeaderSpec, LegSpec, RowSpec
from radmpc.io.flight.record import FlightSettings, NewLeg, ScaleRow, TickRow, Touch
from radmpc.io.native.checking import check_format, validated
from radmpc.io.native.plan_file import decode_plan, encode_plan
from radmpc.io.ranges import FLIGHT_FORMAT
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["decode_header", "decode_row", "encode_header", "encode_row"]


def encode_header(
    plan: Plan, settings: FlightSettings, versions: Mapping[str, str]
) -> dict[str, object]:
    """Return the content of a flight file's first line.

    Parameters
    ----------
    plan : Plan
        What is flown.
    settings : FlightSettings
        How.
    versions : mapping of str to str
        Of the packages that fly.
    """
    return {
        "format": FLIGHT_FORMAT,
        **asdict(settings),
        "versions": dict(versions),
        "plan": encode_plan(plan),
    }


def decode_header(data: object) -> tuple[Plan, FlightSettings, dict[str, str]]:
    """Return the plan, how it was flown, and versions.

    Parameters
    ----------
    data : mapping
        The content of the first line.

    Raises
    ------
    ScenarioError
        If anything is missing, unknown or not allowed.
    """
    spec = validated(HeaderSpec, check_format(data, FLIGHT_FORMAT))
    try:
        plan = decode_plan(spec.plan)
    except ScenarioError as error:
        raise error.under("plan") from error
    if len(plan.trajectories) != plan.scenario.num_vehicles:
        raise ScenarioError(
            f"must be of all {plan.scenario.num_vehicles} vehicles, got {len(plan.trajectories)}",
            ("plan", "vehicles"),
        )
    settings = FlightSettings(
        spec.backend, spec.replan, spec.missions, spec.seed, spec.deadline, spec.options
    )
    return plan, settings, spec.versions


def encode_row(row: TickRow) -> dict[str, object]:
    """Return the content of a tick's line."""
    leg = row.leg
    # Beside covariances that are known there is nothing to tell.
    scale = {} if row.scale is None else {"scale": asdict(row.scale)}
    partly = {} if row.partly is None else {"partly": [_list(each) for each in row.partly]}
    return {
        "mission": row.mission,
        "step": row.step,
        "states": None if row.states is None else _lists(row.states),
        **partly,
        "contacts": [asdict(touch) for touch in row.contacts],
        "choice": row.choice,
        "reason": row.reason,
        "value": row.value,
        "wealth": row.wealth,
        "price": row.price,
        "next_step": row.next_step,
        "tail": row.tail,
        "bank": row.bank,
        "controls": _lists(row.controls),
        "excess": row.excess,
        "leg": None if leg is None else _encoded_leg(leg),
        **scale,
        "alarms": list(row.alarms),
        "seconds": row.seconds,
    }


def _encoded_leg(leg: NewLeg) -> dict[str, object]:
    """Return a leg as its row has it."""
    means = {} if leg.means is None else {"means": _lists(leg.means)}
    return {
        "risk_bound": leg.risk_bound,
        "starts": _lists(leg.starts),
        "controls": _lists(leg.controls),
        **means,
    }


def decode_row(data: object, scenario: Scenario) -> TickRow:
    """Return a tick.

    Parameters
    ----------
    data : mapping
        The content of its line.
    scenario : Scenario
        Of the plan.

    Raises
    ------
    ScenarioError
        If anything is missing, unknown or not allowed, or does not fit the scenario.
    """
    if not isinstance(data, Mapping):
        raise ScenarioError("must be a mapping")
    spec = validated(RowSpec, data)
    if spec.step > scenario.horizon:
        raise ScenarioError(f"must be at most {scenario.horizon}, got {spec.step}", ("step",))
    states = [v.system.num_states for v in scenario.vehicles]
    controls = [v.system.num_controls for v in scenario.vehicles] if spec.controls else []
    return TickRow(
        mission=spec.mission,
        step=spec.step,
        states=None if spec.states is None else _vectors(spec.states, states, "states"),
        contacts=tuple(Touch(c.step, c.cause, c.vehicle, c.other) for c in spec.contacts),
        choice=spec.choice,
        reason=spec.reason,
        value=spec.value,
        wealth=spec.wealth,
        price=spec.price,
        next_step=spec.next_step,
        tail=spec.tail,
        bank=spec.bank,
        controls=_vectors(spec.controls, controls, "controls"),
        excess=spec.excess,
        leg=None if spec.leg is None else _leg(spec.leg, scenario, scenario.horizon - spec.step),
        alarms=tuple(spec.alarms),
        seconds=spec.seconds,
        scale=None if spec.scale is None else ScaleRow(spec.scale.samples, spec.scale.factor),
        partly=_partly(spec, states),
    )


def _partly(spec: RowSpec, sizes: Sequence[int]) -> tuple[Vector | None, ...] | None:
    """Return a vector, or None, per vehicle where some were measured."""
    if spec.partly is None:
        return None
    if spec.states is not None:
        raise ScenarioError("must be left out where all were measured", ("partly",))
    if len(spec.partly) != len(sizes):
        raise ScenarioError(
            f"must be of {len(sizes)} vehicles, got {len(spec.partly)}", ("partly",)
        )
    return tuple(
        None if row is None else as_vector(row, size, ("partly", i))
        for i, (row, size) in enumerate(zip(spec.partly, sizes, strict=True))
    )


def _list(array: Vector | None) -> object:
    """Return a vector as a list of numbers, or None."""
    return None if array is None else array.tolist()


def _lists(arrays: Sequence[Matrix]) -> list[object]:
    """Return arrays as lists of numbers."""
    return [array.tolist() for array in arrays]


def _vectors(rows: Sequence[Sequence[float]], sizes: Sequence[int], key: str) -> tuple[Vector, ...]:
    """Return one vector per vehicle."""
    if len(rows) != len(sizes):
        raise ScenarioError(f"must be of {len(sizes)} vehicles, got {len(rows)}", (key,))
    return tuple(
        as_vector(row, size, (key, i))
        for i, (row, size) in enumerate(zip(rows, sizes, strict=True))
    )


def _leg(spec: LegSpec, scenario: Scenario, left: int) -> NewLeg:
    """Return a leg of the steps that are left."""
    systems = [vehicle.system for vehicle in scenario.vehicles]
    sizes, inputs = [s.num_states for s in systems], [s.num_controls for s in systems]
    controls = _matrices(spec.controls, left, inputs, "controls")
    means = None if spec.means is None else _matrices(spec.means, left + 1, sizes, "means")
    return NewLeg(spec.risk_bound, _vectors(spec.starts, sizes, "leg"), controls, means)


def _matrices(
    given: Sequence[Sequence[Sequence[float]]], steps: int, sizes: Sequence[int], key: str
) -> tuple[Matrix, ...]:
    """Return one matrix per vehicle, of a leg."""
    if len(given) != len(sizes):
        raise ScenarioError(f"must be of {len(sizes)} vehicles, got {len(given)}", ("leg", key))
    return tuple(
        as_matrix(rows, (steps, size), ("leg", key, i))
        for i, (rows, size) in enumerate(zip(given, sizes, strict=True))
    )
