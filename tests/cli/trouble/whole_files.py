"""Files of every format that the program reads, none of them broken."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from radmpc.io.native.plan_file import encode_plan
from radmpc.io.native.scenario_file import decode_scenario, encode_scenario
from radmpc.planning import plan

__all__ = ["ROOM", "SCENARIO", "SPACE", "whole_files"]

INSTANCES = Path(__file__).parents[3] / "instances"

SCENARIO = """\
format: radmpc/scenario/1
name: crossing
dt: 1.0
horizon: 4
risk_bound: 0.05
avoidance: steps
pair_faces: 6
workspace: {min: [0, 0], max: [20, 20]}
obstacles:
  - {name: reef, vertices: [[5, 5], [8, 5], [7, 8], [6, 6]]}
  - {name: pier, min: [10, 0], max: [12, 6]}
  - {name: hull, normals: [[1, 0], [-1, 0], [0, 1], [0, -1]], offsets: [3, -1, 19, -17]}
defaults: &here
  radius: 0.4
  control_limit: 2.0
  initial_covariance: [0.001, 0.001, 0.0001, 0.0001]
  feedback: {lqr: {Q: 1.0, R: [1.0, 2.0]}}
vehicles:
  - {name: a, start: [14, 9], goal: {center: [12, 9], half_width: 0.2, speed: 0.05}}
  - name: "b"
    start: [2, 3]
    goal: {min: [0.8, 1.8], max: [1.2, 2.2]}
    dynamics: {A: [[1, 0], [0, 1]], B: [[1, 0], [0, 1]], position: [0, 1]}
    feedback: null
    cost_weight: 2.0
    initial_covariance: [[0.002, 0.001], [0.001, 0.002]]
"""

SPACE = """\
{"format": "radmpc/scenario/1", "name": "space", "dt": 0.5, "horizon": 3, "risk_bound": 0.01,
 "workspace": {"min": [-9, -9, 0], "max": [9, 9, 9]},
 "obstacles": [{"name": "post", "min": [2, 2, 0], "max": [3, 3, 5]},
  {"name": "kite", "moving": [
   [[4, 4, 4], [5, 4, 4], [4, 5, 4], [4, 4, 5]], [[4, 4, 4], [5, 4, 4], [4, 5, 4], [4, 4, 5]],
   [[4, 4, 4], [5, 4, 4], [4, 5, 4], [4, 4, 5]], [[4, 4, 5], [5, 4, 5], [4, 5, 5], [4, 4, 6]]]}],
 "vehicles": [{"name": "drone", "start": [0, 0, 1], "radius": 0.2, "control_limit": 5.0,
  "speed_limit": [4, 4, 2], "goal": {"center": [1, 0, 1], "half_width": 0.1, "speed": null},
  "disturbance_covariance": 1e-05}],
 "source": {"origin": {"latitude": 54.1, "longitude": 12.1, "height": 3}}}
"""

ROOM = b"type octile\nheight 3\nwidth 8\nmap\n....@@..\n..TT@@..\n........\n"
TASKS = b"""version 1
0\tmaps/room.map\t8\t3\t0\t0\t7\t0\t3.41
3\tmaps/room.map\t8\t3\t1\t0\t1\t2\t2.0
"""


def whole_files() -> dict[str, bytes]:
    """Return contents by name; the ending tells how each is read."""
    found = {"crossing.yaml": SCENARIO.encode(), "space.json": SPACE.encode()}
    for name, scenario in (("crossing", _yaml(SCENARIO)), ("space", json.loads(SPACE))):
        planned = plan(decode_scenario(scenario), rng=0)
        assert planned.is_certified
        found[f"{name}.plan.json"] = json.dumps(encode_plan(planned.record), indent=1).encode()
    found["crossing.json"] = json.dumps(encode_scenario(decode_scenario(_yaml(SCENARIO)))).encode()
    for folder, name in (
        ("db-CBS", "forest.yaml"),
        ("db-CBS", "swap4_double_integrator.yaml"),
        ("s2m2", "zigzag.yaml"),
        ("lsc_planner", "multi_simple4.json"),
        ("libMultiRobotPlanning", "map_8by8_obst12_agents4_ex1.yaml"),
        ("drawn", "marina.geojson"),
        ("drawn", "marina.kml"),
    ):
        found[name] = (INSTANCES / folder / name).read_bytes()
    return found | {"room.scen": TASKS, "room.map": ROOM}


def _yaml(text: str) -> Any:
    """Return the content of YAML text."""
    return YAML(typ="safe", pure=True).load(text)
