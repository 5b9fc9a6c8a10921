from __future__ import annotations

import multiprocessing
import signal
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import hunt
from hunting import checks
from hunting.answers import PLANNERS, Effort
from hunting.catch import KINDS, Catch, Notes, catch_of, clock, watched
from hunting.checks import examine, run_scene
from hunting.flight import plain_collisions, solid_distances
from hunting.scenes import draw_scene
from radmpc.geometry import box, hull
from radmpc.model.plan import Plan
from radmpc.planning import plan
from radmpc.referee import Certificate, simulate
from radmpc.result import Result

SEED = 0
CHUNK = 4
EFFORT = Effort(1.0, 0.5, samples=2_000, planners=("certified", "ira", "dlp", "radmpc"))

# What a slow machine alone brings about is left to long runs: late, late_cpu, dear_late, lost;
# and so are given_up and dear_exact: sides and simple bounds are what is planned with.
SURE = {
    "error", "warning", "unsafe", "unlike", "loose", "infeasible", "dear", "early", "broken",
    "bound",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("chunk", range(75))
def test_nothing_is_caught_in_small_nasty_scenes(chunk: int):
    caught = [run_scene(SEED, i, EFFORT) for i in range(chunk * CHUNK, (chunk + 1) * CHUNK)]
    wrong = [f"{c.index}: {c.notes}" for c in caught if SURE & set(c.kinds.split())]
    assert not wrong, f"seed {SEED}, scenes " + "\n".join(wrong)


@pytest.mark.nightly
def test_a_hunt_that_is_left_stops_its_processes_at_once():
    children = set(multiprocessing.active_children())
    scenes = hunt._run(range(200), 2, SEED, EFFORT)
    next(scenes)
    begun = set(multiprocessing.active_children()) - children
    scenes.close()
    assert len(begun) == 2
    assert [worker.exitcode for worker in begun] == [-signal.SIGTERM] * 2


@pytest.mark.slow
def test_a_seed_and_an_index_decide_the_scene_and_many_make_all_sorts():
    scenes = [draw_scene(1, i) for i in range(150)]
    again = draw_scene(1, 149)
    assert [v.start.tolist() for v in scenes[149].vehicles] == [
        v.start.tolist() for v in again.vehicles
    ]
    vehicles = [v for s in scenes for v in s.vehicles]
    shapes = {type(o.shape).__name__ for s in scenes for o in s.obstacles}
    assert {s.dimension for s in scenes} == {2, 3}
    assert {s.num_vehicles for s in scenes} == {1, 2, 3, 4}
    assert {s.horizon for s in scenes} == set(range(1, 9))
    assert shapes == {"BoxShape", "PolygonShape", "HalfspaceShape", "MovingShape", "LineShape"}
    assert {v.system.is_double_integrator for v in vehicles} == {True, False}
    assert any(v.system.position[0] > 0 for v in vehicles)
    assert any(v.gain is not None for v in vehicles)
    assert any(not v.disturbance_covariance.any() for v in vehicles)


@pytest.fixture(scope="module")
def busy() -> tuple[Result, Plan]:
    """A plan that collides now and then."""
    for index in range(100):
        scenario = replace(draw_scene(2, index), risk_bound=0.3)
        if scenario.num_vehicles < 2:
            continue
        result = plan(scenario, "dlp", time_limit=2.0)
        if result.plan is not None and 0.02 < simulate(result.plan, 1_000, rng=0).rate < 0.9:
            return result, result.plan
    raise AssertionError("no plan collides")


@pytest.mark.slow
def test_plain_flights_collide_as_often_as_simulated_ones(busy: tuple[Result, Plan]):
    flown = simulate(busy[1], 8_000, rng=1).rate
    plain = plain_collisions(busy[1], 8_000, 1) / 8_000
    # Five standard deviations of the difference; a tenth is lost between the moments looked at.
    spread = 5.0 * np.sqrt(2.0 * flown * (1.0 - flown) / 8_000)
    assert 0.9 * flown - spread <= plain <= flown + spread


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("is_flat", [False, True])
def test_distances_to_a_solid_are_those_to_its_nearest_point(dimension: int, is_flat: bool):
    rng = np.random.default_rng(4)
    corners = rng.normal(size=(7, dimension))
    if is_flat:
        corners[:, 0] = 0.3
    solid, points = hull(corners), 1.5 * rng.normal(size=(60, dimension))
    weights = rng.dirichlet(np.full(len(solid.vertices), 0.4), 60_000)
    inside = weights @ solid.vertices
    nearest = np.array([np.linalg.norm(inside - p, axis=1).min() for p in points])
    found = solid_distances(solid, points)
    assert np.all(found <= nearest + 1e-12)
    assert np.all(found >= nearest - 0.12)


def test_distances_to_a_box_are_known():
    points = np.array([[2.0, 0.5, 0.5], [2.0, 2.0, 0.5], [2.0, 2.0, 2.0], [0.5, 0.5, 0.9]])
    expected = [1.0, np.sqrt(2.0), np.sqrt(3.0), 0.0]
    assert solid_distances(box(np.zeros(3), np.ones(3)), points) == pytest.approx(expected)


@cache
def true_answer(name: str) -> Result:
    """What a planner answers to the scene that others are asked about."""
    scenario = replace(draw_scene(SEED, 1), risk_bound=0.3)
    return plan(scenario, PLANNERS[name], rng=1, time_limit=60.0)


def caught_with(monkeypatch: pytest.MonkeyPatch, change: Callable[[str, Result], Result]) -> Catch:
    """Examine a scene whose answers are changed by ``change(name, result)``."""

    def lie(scenario: object, planner: object, **options: object) -> Result:
        [name] = [n for n, p in PLANNERS.items() if p is planner]
        return change(name, true_answer(name))

    monkeypatch.setattr(checks, "plan", lie)
    scenario = replace(draw_scene(SEED, 1), risk_bound=0.3)
    return examine(scenario, SEED, 1, Effort(60.0, 60.0, 0))


@pytest.mark.slow
def test_a_bound_on_any_plan_above_a_certified_one_is_caught(monkeypatch: pytest.MonkeyPatch):
    def change(name: str, result: Result) -> Result:
        if name != "certified":
            return result
        return replace(result, record=replace(result.record, certified_lower_bound=1e3))

    assert "bound" in caught_with(monkeypatch, change).kinds.split()


@pytest.mark.slow
def test_a_lower_bound_above_a_plan_is_caught(monkeypatch: pytest.MonkeyPatch):
    def change(name: str, result: Result) -> Result:
        if name != "certified":
            return result
        return replace(result, record=replace(result.record, lower_bound=1e3))

    assert "bound" in caught_with(monkeypatch, change).kinds.split()


@pytest.mark.slow
def test_a_plan_dearer_than_others_is_caught(monkeypatch: pytest.MonkeyPatch):
    def change(name: str, result: Result) -> Result:
        if name != "certified":
            return result
        cost = 2.0 * float(result.record.cost or 1.0)
        return replace(result, record=replace(result.record, cost=cost, lower_bound=cost))

    assert {"dear", "bound"} <= set(caught_with(monkeypatch, change).kinds.split())


@pytest.mark.slow
def test_a_plan_that_is_lost_is_caught(monkeypatch: pytest.MonkeyPatch):
    def change(name: str, result: Result) -> Result:
        if name != "certified":
            return result
        record = replace(result.record, trajectories=(), cost=None, lower_bound=None)
        return replace(result, record=record, certificate=None)

    assert "lost" in caught_with(monkeypatch, change).kinds.split()


def test_a_certificate_below_the_rate_is_caught(busy: tuple[Result, Plan]):
    result, _ = busy
    low = Certificate(0.3, 1e-9, (), (), 0.0)
    notes = Notes()
    checks._fly(notes, "dlp", replace(result, certificate=low), 2_000, 0)
    assert list(notes.kinds) == ["unsafe"]
    assert len(notes.texts) == 2


def test_what_is_raised_warned_of_or_does_not_end_is_caught():
    notes = Notes()
    with watched(notes, "one", 10.0):
        warnings.warn("that is odd", RuntimeWarning, stacklevel=1)
        raise ValueError("that is wrong")
    assert notes.kinds.keys() == {"error", "warning"}
    if sys.platform != "win32":
        with watched(notes, "two", 0.05):
            while True:
                pass
        assert "not back after" in notes.texts[-1]


def test_a_line_of_the_table_reads_back_and_is_told_in_the_summary():
    catch = Catch(0, 7, 4.0, "steps", 2, 2, 1, 5, 0.1, "optimal", kinds="dear late", notes="a, b")
    assert str(catch_of(catch.as_row())) == str(catch)
    lines = hunt.summary([catch])
    assert [line for line in lines if line.endswith(": 7")] == [
        f"- **{kind}** 1 ({KINDS[kind]}): 7" for kind in ("dear", "late")
    ]


@pytest.mark.slow
def test_an_interrupted_hunt_goes_on_where_it_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    table = tmp_path / "table.csv"

    def run(scenes: int, limit: float = 0.5) -> None:
        words = ["hunt", "--scenes", str(scenes), "--samples", "100", "--out", str(table)]
        monkeypatch.setattr(sys, "argv", [*words, "--time-limit", str(limit)])
        hunt.main()

    run(1)
    before = table.read_text(encoding="utf-8")
    table.write_text(before + "0,99,0.", encoding="utf-8")  # killed while it wrote
    run(2)
    after = table.read_text(encoding="utf-8")
    assert after.startswith(before)
    assert "0,99,0." not in after
    assert "2 scenes" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="another seed"):
        run(2, limit=0.25)


def test_a_scene_is_played_again_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    path = tmp_path / "scene.json"
    words = ["hunt", "--index", "9", "--samples", "100", "--save", str(path)]
    monkeypatch.setattr(sys, "argv", words)
    hunt.main()
    assert "uniform" in capsys.readouterr().out
    assert path.exists()


def test_seconds_of_the_processor_do_not_count_while_others_run():
    wall = time.monotonic()
    with clock(by_processor=True):
        counted = time.monotonic(), time.perf_counter()
        time.sleep(0.2)
        counted = time.monotonic() - counted[0], time.perf_counter() - counted[1]
    assert max(counted) < 0.1
    assert time.monotonic() - wall >= 0.2
