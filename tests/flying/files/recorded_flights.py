"""Small flights that are recorded: a vehicle beside a wall, and a planner that stakes all."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
from adversary import beside_a_wall, staking, waiting

import radmpc
from radmpc.flying.leg import leg_of
from radmpc.flying.model import Model
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.io.flight.flight_file import FlightWriter
from radmpc.io.flight.record import FlightRecord, FlightSettings, TickRow
from radmpc.model.plan import Plan, Risk


def certified(plan: Plan) -> Plan:
    """Return a plan that states the certificate it has."""
    certificate = radmpc.certify(plan)
    ledger, saturation = certificate.ledger, certificate.saturation
    risk = Risk(plan.risk.bound, certificate.certified, ledger, None, saturation)
    return replace(plan, risk=risk)


def beside_the_wall() -> Plan:
    return certified(waiting(beside_a_wall()))


def drifting(dimension: int) -> Plan:
    """A plan that lets a vehicle drift past a rock that moves, far away, for six steps."""
    system = radmpc.double_integrator(1.0, dimension)
    zeros = [0.0] * (dimension - 1)
    vehicle = radmpc.Vehicle(
        name="a",
        system=system,
        start=[0.0, *zeros, 1.0, *zeros],
        goal=radmpc.Goal.at([6.0, *zeros], 2.0, None),
        radius=0.3,
        control_limit=1.0,
        initial_covariance=0.0,
        disturbance_covariance=np.diag([1e-2] * dimension + [1e-4] * dimension),
        gain=-np.hstack([0.2 * np.eye(dimension), 0.6 * np.eye(dimension)]),
    )
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * dimension)).reshape(dimension, -1).T
    if dimension == 2:
        corners = corners[[0, 1, 3, 2]]
    far = np.array([0.0, *[9.0] * (dimension - 1)])
    ahead = np.eye(dimension)[0]
    steps = [corners + far + k * ahead for k in range(7)]
    rock = radmpc.Obstacle.moving("rock", steps)
    scenario = radmpc.Scenario("drift", 1.0, 6, 0.05, (vehicle,), (rock,))
    return certified(leg_of(scenario, [np.zeros((6, dimension))], 0).plan)


def staked_rows(plan: Plan, seed: int = 1) -> list[TickRow]:
    """Fly a plan beside the wall, another leg adopted wherever it can be afforded."""
    rows: list[TickRow] = []
    mission = RecordedMission(plan, 0, rows.append, planner=staking)
    radmpc.fly(mission, Model(plan.scenario, seed))
    return rows


def written(path: Path, plan: Plan, rows: list[TickRow]) -> None:
    """Write a flight of one mission."""
    settings = FlightSettings(replan=None)
    with FlightWriter.begin(path, plan, settings, {"radmpc": "test"}) as writer:
        for row in rows:
            writer.append(row)


def forged(path: Path, line: int, change: Callable[[dict[str, object]], object]) -> None:
    """Change a line, and sign it and all after it anew, as who knows the format would."""
    lines = path.read_text(encoding="utf-8").splitlines()
    digest = ""
    for number, text in enumerate(lines, start=1):
        content = json.loads(text)
        del content["digest"]
        if number == line:
            change(content)
        body = json.dumps(content, ensure_ascii=False)[:-1]
        digest = hashlib.sha256(f"{digest}\n{body}".encode()).hexdigest()[:16]
        lines[number - 1] = f'{body}, "digest": "{digest}"}}'
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def told(value: object) -> object:
    """Return a value with arrays as lists: rows are equal where these are."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [told(item) for item in value]
    if hasattr(value, "__dataclass_fields__"):
        return {field.name: told(getattr(value, field.name)) for field in fields(value)}
    return value


def without_seconds(record: FlightRecord) -> list[object]:
    return [told(row) | {"seconds": 0.0} for row in record.rows]
