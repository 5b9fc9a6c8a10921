"""Small flights that are recorded: a vehicle beside a wall, and a planner that stakes all."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from adversary import beside_a_wall, staking, waiting

import radmpc
from radmpc.flying.model import Model
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.io.flight.flight_file import FlightWriter
from radmpc.io.flight.record import FlightSettings, TickRow
from radmpc.model.plan import Plan, Risk


def certified(plan: Plan) -> Plan:
    """Return a plan that states the certificate it has."""
    certificate = radmpc.certify(plan)
    ledger, saturation = certificate.ledger, certificate.saturation
    risk = Risk(plan.risk.bound, certificate.certified, ledger, None, saturation)
    return replace(plan, risk=risk)


def beside_the_wall() -> Plan:
    return certified(waiting(beside_a_wall()))


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
