"""What a scenario, its parts and a planner say to what they cannot be made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc import (
    Goal,
    ImportOptions,
    LinearSystem,
    Obstacle,
    Planner,
    Scenario,
    ScenarioError,
    Trajectory,
    Vehicle,
    Workspace,
    double_integrator,
    lqr_gain,
)
from radmpc.experiments.comparing import compare
from radmpc.experiments.families import circle
from radmpc.io.export.exporting import Origin
from radmpc.model.dynamics import rollout
from radmpc.planners import Centralized, Couplings, Distance, Ira, Pool, Receding, Sigmas, Uniform
from radmpc.planners.presets import parse_planner
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM
from radmpc.solvers.rrt.rrt import Rrt

Call = Callable[[], object]

SCENE = circle(2)
PLAN = radmpc.plan(SCENE, "dlp").require()
SYSTEM = SCENE.vehicles[0].system
BOAT = SCENE.vehicles[0]
ROCK = Obstacle.box("rock", [0.0, 0.0], [1.0, 1.0])


def scene(**changes: object) -> Scenario:
    return replace(SCENE, **changes)


def boat(**changes: object) -> Vehicle:
    return replace(BOAT, **changes)


SCENARIOS: dict[str, tuple[Call, str]] = {
    "no step": (lambda: double_integrator(0, 2), r"^dt: must be > 0 s, got 0"),
    "a step that is none": (lambda: double_integrator(np.nan, 2), r"^dt: must be > 0 s, got nan"),
    "a step as text": (lambda: double_integrator("1", 2), r"^dt: must be a number, got '1'"),
    "four axes": (lambda: double_integrator(1.0, 4), r"^dimension: must be 2 or 3, got 4"),
    "half an axis": (
        lambda: double_integrator(1.0, 2.5),
        r"^dimension: must be an integer, got 2.5",
    ),
    "feedback that costs nothing": (
        lambda: lqr_gain(double_integrator(1.0, 2), np.eye(4), 0.0 * np.eye(2)),
        r"^R: must be positive definite, got an eigenvalue of 0$",
    ),
    "weights of another size": (lambda: lqr_gain(SYSTEM, np.eye(3), np.eye(2)), r"^Q: must have"),
    "weights as text": (
        lambda: lqr_gain(SYSTEM, "one", np.eye(2)),
        r"^Q: must be numbers, got 'one'",
    ),
    "a start of another size": (lambda: rollout(SYSTEM, [0.0], [[0, 0]]), r"^start: must have 4"),
    "controls of another size": (
        lambda: rollout(SYSTEM, np.zeros(4), [0, 0]),
        r"^controls: must have",
    ),
    "an index with a point": (
        lambda: LinearSystem(np.eye(2), np.eye(2), (0, 1.5), None),
        r"^position\[1\]: must be an integer, got 1.5",
    ),
    "an index alone": (
        lambda: LinearSystem(np.eye(2), np.eye(2), 0, None),
        r"^position: must be distinct .* got 0",
    ),
    "no position": (
        lambda: LinearSystem(np.eye(2), np.eye(2), None, None),
        r"^position: .* got None$",
    ),
    "no place in a fleet": (lambda: SCENE.subset([2], 0.1), r"^indices: .* from 0 to 1, got \[2\]"),
    "a place of text": (
        lambda: SCENE.subset("x", 0.1),
        r"^indices\[0\]: must be an integer, got 'x'",
    ),
    "a place of another plane": (lambda: BOAT.goal.contains([0], None), r"^position: must have 2"),
    "a part of a plan without a name": (
        lambda: Trajectory(3, [[0]], [[0]], [[[0]]]),
        r"^name: must be text, got 3",
    ),
    "a number too large": (lambda: boat(radius=10**400), r"^radius: must be a number, got 10"),
    "truth for a limit": (
        lambda: boat(control_limit=True),
        r"^control_limit: must be numbers, got T",
    ),
    "a list for a word": (
        lambda: Receding("reset", ["once"]),
        r"arrivals must be 'once' or 'every_",
    ),
    "a policy for an approximation": (
        lambda: Couplings(0.1, Pool()),
        r"must be a Receding, got a P",
    ),
    "an unknown charge": (
        lambda: Pool("none"),
        r"charge must be 'allocated' or 'used', got 'none'",
    ),
    "a share above one": (lambda: Ira(keep=2), r"keep must lie between 0 and 1, got 2"),
    "no iterations": (
        lambda: Ira(max_iterations=0),
        r"max_iterations must be an integer >= 1, got 0",
    ),
    "a list for a solver": (
        lambda: BigM(["highs"]),
        r"backend must be one of highs, .* \['highs'\]",
    ),
    "matrices as text": (
        lambda: LinearSystem("A", "B", (0, 1), None),
        r"^A: must be numbers, got 'A'",
    ),
    "a radius as text": (lambda: boat(radius="2"), r"^radius: must be a number, got '2'"),
    "a radius as truth": (lambda: boat(radius=True), r"^radius: must be a number, got True"),
    "no radius": (lambda: boat(radius=None), r"^radius: must be a number, got None"),
    "a number for a name": (lambda: boat(name=3), r"^name: must be text, got 3"),
    "a number for a goal": (lambda: boat(goal=[1, 2]), r"^goal: must be a Goal, got \[1, 2\]"),
    "a number for dynamics": (
        lambda: boat(system=1.0),
        r"^system: must be a LinearSystem, got 1.0",
    ),
    "a limit as text": (
        lambda: boat(control_limit="2"),
        r"^control_limit: must be numbers, got '2'",
    ),
    "limits as text": (lambda: boat(control_limit=["1", "2"]), r"^control_limit: .* \['1', '2'\]"),
    "a ragged limit": (
        lambda: boat(control_limit=[1, [2]]),
        r"^control_limit: must be numbers of eq",
    ),
    "a complex start": (lambda: boat(start=[1j, 0.0]), r"^start: must be numbers, got \[1j, 0.0\]"),
    "noise as text": (
        lambda: boat(initial_covariance="x"),
        r"^initial_covariance: must be numbers",
    ),
    "ragged noise": (lambda: boat(initial_covariance=[1, [2], 3, 4]), r"^initial_covariance: must"),
    "sigmas as text": (
        lambda: boat(control_sigmas="3"),
        r"^control_sigmas: must be a number, got '3'",
    ),
    "a weight of nothing": (lambda: boat(cost_weight=None), r"^cost_weight: must be a number"),
    "a goal as text": (lambda: Goal("a", "b", None), r"^min: must be numbers, got 'a'"),
    "a goal around nothing": (lambda: Goal.at(None), r"^center: must "),
    "a workspace of text": (lambda: Workspace("a", "b"), r"^min: must be numbers, got 'a'"),
    "a horizon with a point": (
        lambda: scene(horizon=10.5),
        r"^horizon: must be an integer, got 10.5",
    ),
    "a horizon as truth": (lambda: scene(horizon=True), r"^horizon: must be an integer, got True"),
    "a horizon as text": (lambda: scene(horizon="10"), r"^horizon: must be an integer, got '10'"),
    "a step of text": (lambda: scene(dt="1"), r"^dt: must be a number, got '1'"),
    "a risk as text": (
        lambda: scene(risk_bound="0.1"),
        r"^risk_bound: must be a number, got '0.1'",
    ),
    "a scenario without a name": (lambda: scene(name=None), r"^name: must be text, got None"),
    "a vehicle alone": (
        lambda: scene(vehicles=BOAT),
        r"^vehicles: must be a sequence of Vehicles, g",
    ),
    "an obstacle for a vehicle": (
        lambda: scene(vehicles=[BOAT, ROCK]),
        r"^vehicles\[1\]: must be a Vehicle, got an Obstacle",
    ),
    "an obstacle alone": (lambda: scene(obstacles=ROCK), r"^obstacles: must be a sequence of Obst"),
    "a vehicle for an obstacle": (
        lambda: scene(obstacles=[BOAT]),
        r"^obstacles\[0\]: must be an Obstacle, got a Vehicle",
    ),
    "a word for avoidance": (lambda: scene(avoidance="never"), r"^avoidance: must be 'steps' or"),
    "a list for avoidance": (lambda: scene(avoidance=["steps"]), r"^avoidance: must be 'steps' or"),
    "faces with a point": (
        lambda: scene(pair_faces=4.5),
        r"^pair_faces: must be an integer, got 4.5",
    ),
    "corners for a workspace": (
        lambda: scene(workspace=([0, 0], [1, 1])),
        r"^workspace: must be a Workspace or None, got",
    ),
    "a text for a source": (
        lambda: scene(source="map"),
        r"^source: must be a mapping or None, got",
    ),
    "a number for an obstacle's name": (
        lambda: Obstacle.box(3, [0, 0], [1, 1]),
        r"^name: must be text, got 3",
    ),
    "a polygon of text": (lambda: Obstacle.polygon("a", "abc"), r"^vertices: must be numbers"),
    "a box of nothing": (lambda: Obstacle.box("a", None, [1, 1]), r"^min: must "),
    "half-spaces of text": (
        lambda: Obstacle.halfspaces("a", "x", [1]),
        r"^normals: must be numbers",
    ),
    "a still outline": (
        lambda: Obstacle.moving("a", 3),
        r"^moving: must be one outline per step, g",
    ),
    "controls as text": (
        lambda: Trajectory("a", "x", [[0]], [[[0]]]),
        r"^controls: must be numbers",
    ),
    "a planner with a hole": (lambda: parse_planner("nope("), r"planner must be one of .* 'nope\("),
    "a planner that is a number": (lambda: parse_planner(3), r"planner must be one of .*, got 3"),
    "a threshold that is none": (lambda: parse_planner("multi-vehicle(nan)"), r"threshold must be"),
    "an unknown planner": (
        lambda: radmpc.plan(SCENE, "best"),
        r"planner must be one of milp.*'best'",
    ),
    "an unknown planner to compare": (lambda: compare(SCENE, ["best"]), r"planner must be one of"),
    "a name for a policy": (
        lambda: Planner("uniform", Branch(), Centralized()),
        r"policy must be a record such as Uniform\(\), got 'unif",
    ),
    "a class for a solver": (
        lambda: Planner(Uniform(), Branch, Centralized()),
        r"solver must be a record such as Branch\(\), got .*class Branch",
    ),
    "nothing for a decomposition": (
        lambda: Planner(Uniform(), Branch(), None),
        r"decomposition must be a record such as Centralized\(\), got None",
    ),
    "a gap as text": (
        lambda: Planner(Uniform(), Branch(), Centralized(), "1"),
        r"gap must lie .* got '1'",
    ),
    "half a node": (lambda: Rrt(max_nodes=1.5), r"max_nodes must be at least 1, got 1.5"),
    "sigmas of a policy": (lambda: Sigmas("3"), r"sigmas must lie between 0 and 7, got '3'"),
    "sigmas of a horizon": (
        lambda: Receding(sigmas="3"),
        r"sigmas must lie between 0 and 10, got '3'",
    ),
    "a threshold as text": (lambda: Couplings("x"), r"couplings threshold must be .*, got 'x'"),
    "a distance as text": (
        lambda: Distance("x"),
        r"distance must be a number of meters >= 0, got 'x'",
    ),
    "an imported step": (lambda: ImportOptions(dt="1"), r"^dt: must be a number, got '1'"),
    "an imported horizon": (lambda: ImportOptions(horizon=10.5), r"^horizon: must be an integer"),
    "half an agent": (lambda: ImportOptions(agents=1.5), r"^agents: must be an integer, got 1.5"),
    "an imported risk": (lambda: ImportOptions(risk_bound="1"), r"^risk_bound: must be a number"),
    "an imported word": (lambda: ImportOptions(avoidance=[1]), r"^avoidance: must be 'steps' or"),
    "an unknown format": (lambda: radmpc.save_export(PLAN, "doc", "x"), r"must be one of .* 'doc'"),
    "a place as text": (lambda: Origin("a", 0.0), r"^latitude: must lie between .*, got 'a'"),
    "data that are none": (lambda: radmpc.from_dict(PLAN), r"must be a mapping, got a Plan"),
}


@pytest.mark.parametrize(("call", "expected"), SCENARIOS.values(), ids=SCENARIOS)
def test_a_part_is_refused_with_its_place_and_what_is_allowed(call: Call, expected: str) -> None:
    with pytest.raises(ScenarioError, match=expected) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 250
