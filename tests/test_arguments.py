"""What public functions say to arguments that they cannot be called with."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

import radmpc
from radmpc import (
    ArgumentError,
    ArgumentTypeError,
    ExportOptions,
    Obstacle,
    Planner,
    Scenario,
    Vehicle,
    lqr_gain,
)
from radmpc.experiments.comparing import compare
from radmpc.experiments.families import circle, clutter, fleet, paper
from radmpc.model.dynamics import rollout
from radmpc.plotting import Panel, plot_risk_map, plot_risk_shares, save_axes, save_ledger

Call = Callable[[], object]

SCENE = circle(2)
RESULT = radmpc.plan(SCENE, "dlp")
PLAN = RESULT.require()
SYSTEM = SCENE.vehicles[0].system
BOAT = SCENE.vehicles[0]
FLAT, SPACE = (Figure().add_subplot(projection=kind) for kind in (None, "3d"))
ROCK = Obstacle.box("rock", [0.0, 0.0], [1.0, 1.0])


def scene(**changes: object) -> Scenario:
    return replace(SCENE, **changes)


def boat(**changes: object) -> Vehicle:
    return replace(BOAT, **changes)


ARGUMENTS: dict[str, tuple[Call, str]] = {
    "a file's name for a scenario": (
        lambda: radmpc.plan("fleet.yaml"),
        r"scenario must be a Scenario, got 'fleet.yaml': radmpc.load_scenario reads files",
    ),
    "a plan for a scenario": (lambda: radmpc.plan(PLAN), r"got a Plan: its question is .scenario"),
    "a result for a scenario": (lambda: radmpc.plan(RESULT), r"got a Result: its question is"),
    "a dict for a scenario": (lambda: radmpc.plan({}), r"got a dict: radmpc.from_dict makes one"),
    "a class for a scenario": (lambda: radmpc.plan(Scenario), r"got the class Scenario$"),
    "a negative time": (lambda: radmpc.plan(SCENE, time_limit=-1), r"of seconds >= 0 .*, got -1$"),
    "a time that is none": (lambda: radmpc.plan(SCENE, time_limit=np.nan), r"time_limit.*got nan"),
    "time as text": (lambda: radmpc.plan(SCENE, time_limit="5"), r"time_limit must be .* got '5'"),
    "time as truth": (lambda: radmpc.plan(SCENE, time_limit=True), r"time_limit must .* got True"),
    "a seed as text": (lambda: radmpc.plan(SCENE, rng="a"), r"rng must be an integer >= 0, .* 'a'"),
    "a negative seed": (lambda: radmpc.plan(SCENE, rng=-1), r"rng must be an integer >= 0.*got -1"),
    "a seed with a point": (lambda: radmpc.plan(SCENE, rng=1.5), r"rng must be .*, got 1.5"),
    "an old generator": (
        lambda: radmpc.plan(SCENE, rng=np.random.RandomState(0)),
        r"numpy.random.Generator or None, got a RandomState",
    ),
    "a number for a planner": (lambda: radmpc.plan(SCENE, 3), r"planner must be a Planner or one"),
    "two planners": (lambda: radmpc.plan(SCENE, ["ira", "radmpc"]), r"certified, got \['ira', 'ra"),
    "a planner's class": (lambda: radmpc.plan(SCENE, Planner), r"got the class Planner"),
    "workers for an executor": (
        lambda: radmpc.plan(SCENE, executor=4),
        r"executor must be .*Executor or None, got 4",
    ),
    "progress that is no function": (
        lambda: radmpc.plan(SCENE, progress=True),
        r"progress must be a function or None, got True",
    ),
    "stop that is no function": (lambda: radmpc.plan(SCENE, stop=1), r"stop must be a function"),
    "a scenario certified": (
        lambda: radmpc.certify(SCENE),
        r"plan must be a Plan, got a Scenario: radmpc.plan makes one",
    ),
    "a result certified": (
        lambda: radmpc.certify(RESULT),
        r"plan must be a Plan, got a Result: its plan is .require",
    ),
    "a file certified": (lambda: radmpc.certify("a.json"), r"got 'a.json': radmpc.load_plan reads"),
    "no plan certified": (lambda: radmpc.certify(None), r"plan must be a Plan, got None$"),
    "a result flown": (lambda: radmpc.simulate(RESULT), r"plan must be a Plan, got a Result"),
    "flights with a point": (
        lambda: radmpc.simulate(PLAN, 1e4),
        r"samples must be an integer >= 1, got 10000.0: write 10000$",
    ),
    "an avoidance of nobody": (
        lambda: radmpc.certify(PLAN, avoidance="always"),
        r"avoidance must be 'intervals', 'steps' or None, got 'always'$",
    ),
    "an avoidance of numbers": (
        lambda: radmpc.simulate(PLAN, 9, avoidance=1),
        r"avoidance must be .*, got 1$",
    ),
    "a result drawn": (lambda: radmpc.plot_plan(RESULT), r"got a Result: its plan is .require"),
    "a result's picture": (lambda: radmpc.save_figure(RESULT, "x.png"), r"got a Result: its plan"),
    "a result's ledger": (lambda: save_ledger(RESULT, "x.png"), r"got a Result: its plan is"),
    "a result filmed": (lambda: radmpc.animate_plan(RESULT), r"got a Result: its plan is"),
    "a result's film": (
        lambda: radmpc.save_animation(RESULT, "x.gif"),
        r"got a Result: its plan is",
    ),
    "a result exported": (
        lambda: radmpc.save_export(RESULT, "csv", "x"),
        r"got a Result: its plan is .require",
    ),
    "a result as arrays": (lambda: radmpc.to_xarray(RESULT), r"got a Result: its plan is"),
    "a result in a panel": (lambda: Panel("x", RESULT), r"got a Result: its plan is"),
    "half a flight": (lambda: radmpc.simulate(PLAN, 0.5), r"samples must be .* >= 1, got 0.5$"),
    "no flights": (lambda: radmpc.simulate(PLAN, 0), r"samples must be an integer >= 1, got 0$"),
    "flights as text": (lambda: radmpc.simulate(PLAN, "9"), r"samples must be .*, got '9'$"),
    "flights as truth": (lambda: radmpc.simulate(PLAN, True), r"samples must be .*, got True$"),
    "endless flights": (lambda: radmpc.simulate(PLAN, np.inf), r"samples must be .*, got inf$"),
    "flights from a bad seed": (lambda: radmpc.simulate(PLAN, 9, rng="a"), r"rng must .* got 'a'"),
    "flights before zero": (lambda: radmpc.simulate(PLAN, 9, rng=-1), r"rng must be .*, got -1"),
    "progress of flights": (
        lambda: radmpc.simulate(PLAN, 9, progress=1),
        r"progress must be a fun",
    ),
    "a system for a gain": (
        lambda: lqr_gain(SYSTEM.A, 1, 1),
        r"system must be a LinearSystem, got",
    ),
    "a system for a rollout": (lambda: rollout(BOAT, [0], [[0]]), r"system must .* got a Vehicle"),
    "a number for a scenario's file": (
        lambda: radmpc.load_scenario(3),
        r"path must be the name of a file \(str or Path\), got 3",
    ),
    "nothing for a plan's file": (lambda: radmpc.load_plan(None), r"path must .* got None"),
    "a scenario for a plan's file": (lambda: radmpc.load_plan(SCENE), r"path must .* a Scenario"),
    "a result saved": (
        lambda: radmpc.save_plan(RESULT, "x"),
        r"got a Result: its plan is .require",
    ),
    "arguments of saving swapped": (
        lambda: radmpc.save_plan("x", PLAN),
        r"plan must be a Plan, got",
    ),
    "a plan saved to a number": (lambda: radmpc.save_plan(PLAN, 1), r"path must be .*, got 1"),
    "a plan saved as a scenario": (
        lambda: radmpc.save_scenario(PLAN, "x.yaml"),
        r"got a Plan: its",
    ),
    "a scenario saved to nothing": (lambda: radmpc.save_scenario(SCENE, None), r"path must be"),
    "a result as data": (lambda: radmpc.to_dict(RESULT), r"value must be a Scenario, got a Result"),
    "a result as a table": (lambda: radmpc.to_pandas(RESULT), r"plan must be a Plan, got a Result"),
    "an unknown table": (lambda: radmpc.to_pandas(PLAN, "x"), r"table must be 'trajectories' or"),
    "no table": (lambda: radmpc.to_pandas(PLAN, None), r"table must be .*, got None"),
    "a scenario as arrays": (
        lambda: radmpc.to_xarray(SCENE),
        r"plan must be a Plan, got a Scenario",
    ),
    "a number imported": (lambda: radmpc.import_scenario(3), r"path must be .*, got 3"),
    "import options as a dict": (
        lambda: radmpc.import_scenario("x", {"dt": 1}),
        r"options must be ImportOptions or None",
    ),
    "a scenario exported": (lambda: radmpc.save_export(SCENE, "csv", "x"), r"plan must be a Plan"),
    "an export to nowhere": (
        lambda: radmpc.save_export(PLAN, "csv", None),
        r"path must be .* None",
    ),
    "export options as a dict": (
        lambda: radmpc.save_export(PLAN, "csv", "x", {}),
        r"options must be ExportOptions or None",
    ),
    "an origin as a pair": (lambda: ExportOptions(origin=(1, 2)), r"origin must be an Origin or"),
    "a height as text": (
        lambda: ExportOptions(altitude="3"),
        r"altitude must be a number of meter",
    ),
    "a certificate as text": (
        lambda: ExportOptions(is_certified="no"),
        r"is_certified must be True",
    ),
    "a scenario drawn as a plan": (lambda: radmpc.plot_plan(SCENE), r"got a Scenario: radmpc.plan"),
    "a plan drawn as a scenario": (lambda: radmpc.plot_scenario(PLAN), r"got a Plan: its question"),
    "a figure for axes": (
        lambda: radmpc.plot_plan(PLAN, Figure()),
        r"ax must be one of .* a Figure",
    ),
    "axes of space": (
        lambda: radmpc.plot_plan(PLAN, SPACE),
        r"ax must be flat for a scenario in 2-",
    ),
    "a scene on axes of space": (lambda: radmpc.plot_scenario(SCENE, SPACE), r"ax must be flat"),
    "a ledger of a result": (lambda: radmpc.plot_ledger(RESULT), r"got a Result: its plan is"),
    "a map of a scenario": (lambda: plot_risk_map(SCENE), r"plan must be a Plan, got a Scenario"),
    "shares of a scenario": (
        lambda: plot_risk_shares(SCENE),
        r"plan must be a Plan, got a Scenario",
    ),
    "risk of a result": (lambda: radmpc.plot_risk(RESULT), r"plan must be a Plan, got a Result"),
    "risk on text": (lambda: radmpc.plot_risk(PLAN, "ax"), r"ax must be one of .*, got 'ax'"),
    "distances of a result": (lambda: radmpc.plot_distances(RESULT), r"plan must be a Plan"),
    "no distances": (lambda: radmpc.plot_distances(PLAN, most=0), r"most must be an integer >= 1"),
    "couplings of a result": (
        lambda: radmpc.plot_couplings(RESULT),
        r"plan must be a Plan, got a R",
    ),
    "couplings on a list": (lambda: radmpc.plot_couplings(PLAN, [1]), r"ax must be .*, got \[1\]"),
    "a title of a number": (lambda: radmpc.plot_plan(PLAN, title=3), r"title must be text or None"),
    "endless time": (
        lambda: radmpc.plan(SCENE, time_limit=10**400),
        r"time_limit must be a number",
    ),
    "a horizon below zero": (
        lambda: BOAT.covariances(-1),
        r"horizon must be an integer >= 0, got -1",
    ),
    "a film of a result": (
        lambda: radmpc.animate_plan(RESULT),
        r"plan must be a Plan, got a Result",
    ),
    "a film of no frames": (
        lambda: radmpc.animate_plan(PLAN, frames_per_step=0),
        r"frames_per_step must be an integer from 1 to 50, got 0",
    ),
    "a film of half frames": (
        lambda: radmpc.animate_plan(PLAN, frames_per_step=2.5),
        r"frames_per_step must be .* got 2.5",
    ),
    "a film saved to nowhere": (lambda: radmpc.save_animation(PLAN, None), r"path must be .* None"),
    "a film of a scenario": (lambda: radmpc.save_animation(SCENE, "x.gif"), r"plan must be a Plan"),
    "a figure of a result": (
        lambda: radmpc.save_figure(RESULT, "x.png"),
        r"plan must be a Plan, got",
    ),
    "a figure to a number": (lambda: radmpc.save_figure(PLAN, 3), r"path must be .*, got 3"),
    "axes saved as a plan": (lambda: save_axes(PLAN, "x.png"), r"axes must be .*Axes, got a Plan"),
    "fewer than no vehicles": (
        lambda: paper(-1, 0),
        r"num_vehicles must be an integer from 1 to 10000, got -1",
    ),
    "half a vehicle": (lambda: circle(2.5), r"num_vehicles must be .*, got 2.5"),
    "a fleet of none": (lambda: fleet(0, 0), r"num_vehicles must be .*, got 0"),
    "a fleet's seed": (lambda: fleet(8, -1), r"seed must be an integer >= 0, got -1"),
    "too many boxes": (lambda: clutter(2, 2000, 0), r"num_boxes must be an integer from 0 to 1024"),
    "a plan to fly": (
        lambda: radmpc.fly(PLAN, radmpc.Model(SCENE)),
        r"mission must be a Mission or a LongMission, got a Plan: radmpc.Mission makes one",
    ),
    "a name to fly with": (
        lambda: radmpc.fly(radmpc.Mission(radmpc.plan(SCENE, "rmpc")), "model"),
        r"backend must have reset and advance, as radmpc.Model has, got 'model'",
    ),
    "a log's name to identify": (
        lambda: radmpc.identify("log.csv"),
        r"tracks must be a sequence of Track, got 'log.csv': radmpc.read_logs reads files",
    ),
    "one track to identify": (lambda: radmpc.identify(PLAN), r"tracks must be .*, got a Plan"),
    "plans to identify": (lambda: radmpc.identify([PLAN]), r"tracks must be .*, got a Plan in"),
    "one name to compare": (
        lambda: compare(SCENE, "ira"),
        r"planners must be a sequence of names, got 'ira'",
    ),
    "a file to compare": (lambda: compare("a.yaml", ["ira"]), r"scenario must be a Scenario"),
    "no flights to compare": (lambda: compare(SCENE, ["ira"], samples=0), r"samples must be"),
    "no time to compare": (lambda: compare(SCENE, ["ira"], time_limit=-1), r"time_limit must be"),
    "no seed to compare": (
        lambda: compare(SCENE, ["ira"], rng=None),
        r"rng must be an integer >= 0",
    ),
}


def check_one_line(error: Exception) -> None:
    assert isinstance(error, radmpc.RadmpcError)
    assert isinstance(error, ValueError)
    assert "\n" not in str(error)
    assert len(str(error)) < 250


@pytest.mark.parametrize(("call", "expected"), ARGUMENTS.values(), ids=ARGUMENTS)
def test_an_argument_is_refused_with_what_is_allowed(call: Call, expected: str) -> None:
    with pytest.raises(ArgumentError, match=expected) as caught:
        call()
    check_one_line(caught.value)


def test_an_argument_of_another_kind_is_a_type_error_too() -> None:
    with pytest.raises(TypeError, match="samples"):
        radmpc.simulate(PLAN, "9")
    with pytest.raises(ArgumentError) as caught:
        radmpc.simulate(PLAN, 0)
    assert not isinstance(caught.value, TypeError)
    for again in (copy.copy, lambda e: pickle.loads(pickle.dumps(e))):
        assert type(again(ArgumentTypeError("x"))) is ArgumentTypeError
