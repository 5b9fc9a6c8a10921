"""Spoiled files: whatever they hold, reading them ends in a value or in one line."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.formats import import_scenario
from radmpc.io.native.plan_file import decode_plan, encode_plan, load_plan
from radmpc.io.native.scenario_file import decode_scenario, encode_scenario, load_scenario
from radmpc.model.plan import Plan, Risk, Status, Trajectory
from sampling import IS_THOROUGH

ROOT = Path(__file__).parent.parent.parent
FOREST = ROOT / "instances" / "db-CBS" / "forest.yaml"

SCENARIO = """\
format: radmpc/scenario/1
name: crossing
dt: 1.0
horizon: 1
risk_bound: 0.05
workspace: {min: [0, 0], max: [20, 20]}
obstacles:
  - {name: reef, vertices: [[5, 5], [8, 5], [7, 8], [6, 6]]}
  - {name: pier, min: [10, 0], max: [12, 6]}
  - {name: hull, normals: [[1, 0], [-1, 0], [0, 1], [0, -1]], offsets: [3, -1, 9, -7]}
  - {name: ferry, moving: [[[1, 1], [2, 1], [2, 2]], [[2, 1], [3, 1], [3, 2]]]}
defaults: &here
  radius: 0.4
  control_limit: 2.0
  initial_covariance: [0.001, 0.001, 0.0001, 0.0001]
  feedback: {lqr: {Q: 1.0, R: [1.0, 2.0]}}
vehicles:
  - {name: a, start: [1, 2], goal: {center: [12, 9], half_width: 0.2, speed: 0.05}}
  - name: "b"
    start: [12, 9]
    goal: {min: [0.8, 1.8], max: [1.2, 2.2]}
    dynamics: {A: [[1, 0], [0, 1]], B: [[1, 0], [0, 1]], position: [0, 1]}
    feedback: null
    initial_covariance: [[2, 1], [1, 2]]
"""

BITS = [
    "", "\0", "\t", "\n", "  ", "-", "- ", ": ", "[", "]", "{", "}", '"', "'", "#", "&here ",
    "*here", "!!str ", "!x ", "|", ">", "%YAML 1.1\n---\n", "---\n", "...\n", "?", "<<: *here\n",
    "1e999", "-1e308", "nan", ".nan", "true", "null", "0", "-1", "9" * 500, "0x" + "f" * 999,
    "\u2028", "\ud83d", "\x85", "é", "\\ud800", "\\", "@", "`", ",", "[" * 300, "\ufeff",
]  # fmt: skip

VALUES = [
    None, True, "", "x", 0, -1, 1, 2.5, 1e308, 1e-320, float("nan"), float("inf"), 10**400, [], {},
    [[]], [[], []], [None], ["x"], [1, 2, 3], [[1, 2], [3]], {"": 1}, {"name": 1}, "\ud800", 5,
    [[0, 0], [0, 0], [0, 0]], [[1e9, 1e9], [-1e9, 1e9], [1e-9, 0]], [0, 0], [[1e-300, 0]] * 4,
]  # fmt: skip


def spoiled_texts(text: str, count: int) -> Iterator[str]:
    rng = random.Random(text)
    for _ in range(count):
        broken = text
        for _ in range(rng.randint(1, 3)):
            at = rng.randrange(len(broken) + 1)
            end = min(len(broken), at + rng.choice([0, 0, 1, 5, 40]))
            broken = broken[:at] + rng.choice(BITS) + broken[end:]
        yield broken


def spoiled_values(data: object, count: int) -> Iterator[Any]:
    rng = random.Random(repr(data))
    for _ in range(count):
        broken = copy.deepcopy(data)
        for _ in range(rng.randint(1, 2)):
            spoil(broken, rng)
        yield broken


def spoil(data: Any, rng: random.Random) -> None:
    """Go down at random and replace, remove or add what is there."""
    while isinstance(data, dict | list) and data:
        key = rng.choice(list(data)) if isinstance(data, dict) else rng.randrange(len(data))
        if isinstance(data[key], dict | list) and rng.random() < 0.8:
            data = data[key]
            continue
        action = rng.random()
        if action < 0.2:
            del data[key]
        elif action < 0.3 and isinstance(data, list):
            data.append(rng.choice(VALUES))
        else:
            data[key] = copy.deepcopy(rng.choice(VALUES))
        return


def scenario_data() -> dict[str, object]:
    return encode_scenario(load_text(SCENARIO))


def load_text(text: str) -> Any:
    return decode_scenario(YAML(typ="safe", pure=True).load(text))


def plan_data() -> dict[str, object]:
    scenario = load_text(SCENARIO)
    parts = tuple(
        Trajectory(v.name, [[0.5, 0.0]], [v.start, v.start], v.covariances(1), v.gain)
        for v in scenario.vehicles
    )
    plan = Plan(
        scenario, "p", 0, Status.OPTIMAL, 1.0, 1.0, Risk(0.05), (("a", "b"),), trajectories=parts
    )
    return encode_plan(plan)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("load", "suffix", "text"),
    [
        (load_scenario, ".yaml", SCENARIO),
        (load_scenario, ".json", json.dumps(scenario_data(), indent=1)),
        (load_plan, ".json", json.dumps(plan_data(), indent=1)),
        (import_scenario, ".yaml", FOREST.read_text(encoding="utf-8")),
    ],
    ids=["scenario.yaml", "scenario.json", "plan.json", "dynobench.yaml"],
)
def test_a_spoiled_file_ends_in_one_line(
    tmp_path: Path, load: Callable[[Path], object], suffix: str, text: str
) -> None:
    path = tmp_path / f"spoiled{suffix}"
    num_refused = 0
    num_cases = 250 if IS_THOROUGH else 40
    for broken in spoiled_texts(text, num_cases):
        path.write_bytes(broken.encode("utf-8", "surrogatepass"))
        line = refusal(load, path)
        if line is not None:
            num_refused += 1
            assert line.startswith(f"{path}:")
            assert line.isprintable()
            assert len(line) <= 400
    assert num_refused > num_cases // 2


def refusal(load: Callable[[Path], object], path: Path) -> str | None:
    try:
        load(path)
    except FileFormatError as error:
        return str(error)
    return None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("decode", "data"),
    [(decode_scenario, scenario_data()), (decode_plan, plan_data())],
    ids=["scenario", "plan"],
)
def test_spoiled_data_end_in_a_scenario_error(
    decode: Callable[[object], object], data: dict[str, object]
) -> None:
    num_refused = 0
    num_cases = 800 if IS_THOROUGH else 120
    for broken in spoiled_values(data, num_cases):
        try:
            decode(broken)
        except ScenarioError:
            num_refused += 1
    assert num_refused > num_cases // 2
