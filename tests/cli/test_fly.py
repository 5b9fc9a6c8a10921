"""`radmpc fly`: what it prints, writes, refuses and keeps."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from types import ModuleType

import pytest
from typer.testing import CliRunner

from radmpc.cli import app
from radmpc.console.commands import flying
from radmpc.errors import RadmpcError
from radmpc.flying import backends
from radmpc.flying.backends import BackendKind
from radmpc.flying.model import Model
from radmpc.flying.tick import Contact
from radmpc.io.flight.flight_file import load_flight
from radmpc.plotting.flight import film

from .conftest import CROSSING, Run, assert_one_line

LEAST_KEYS = [
    "missions", "rate", "rate_low", "rate_high", "bound", "certified", "effort", "effort_planned",
    "miss", "saturation", "accepted", "alarms", "tick_p50", "tick_p99", "tick_max",
    "late", "cut_off",
]  # fmt: skip


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A certified plan of the crossing."""
    folder = tmp_path_factory.mktemp("planned")
    (folder / "crossing.yaml").write_text(CROSSING, encoding="utf-8")
    words = ["plan", str(folder / "crossing.yaml"), "-o", str(folder / "crossing.plan.json")]
    assert CliRunner().invoke(app, words).exit_code == 0
    return (folder / "crossing.plan.json").read_bytes()


@pytest.fixture
def plan(tmp_path: Path, planned: bytes) -> Path:
    path = tmp_path / "crossing.plan.json"
    path.write_bytes(planned)
    return path


def test_json_tells_rates_effort_and_ticks(run: Run, plan: Path) -> None:
    result = run("fly", plan, "--replan", "none", "--missions", 3, "--seed", 5, "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert set(LEAST_KEYS) <= set(told)
    assert (told["missions"], told["with"], told["replan"], told["seed"]) == (3, "model", None, 5)
    assert 0.0 == told["rate_low"] == told["rate"] < told["rate_high"]
    assert told["certified"] <= told["bound"] == 0.05
    assert told["effort"] == pytest.approx(told["effort_planned"])
    assert 0.0 < told["tick_p50"] <= told["tick_p99"] <= told["tick_max"]
    assert (told["accepted"], told["ticks"]) == (0.0, 21)


@pytest.mark.slow
def test_a_mission_that_plans_anew_shows_its_account_and_goes_on_where_it_was_cut(
    run: Run, plan: Path, tmp_path: Path
) -> None:
    result = run("fly", plan, "--missions", 1, "-o", "a.jsonl")
    assert result.exit_code == 0, result.output
    assert run("verify", "a.jsonl").exit_code == 0
    whole = load_flight(tmp_path / "a.jsonl")
    lines = (tmp_path / "a.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    (tmp_path / "a.jsonl").write_text("".join(lines[:6]) + lines[6][:100], encoding="utf-8")
    assert run("fly", "a.jsonl").exit_code == 0
    again = load_flight(tmp_path / "a.jsonl")
    assert [row.bank for row in again.rows] == [row.bank for row in whole.rows]
    assert [row.leg is None for row in again.rows] == [row.leg is None for row in whole.rows]
    lines = result.stdout.splitlines()
    assert lines[1].split()[:4] == ["flown", "1", "of", "1"]
    assert "planned anew by certified" in lines[1]
    head = lines.index("step      tail  remaining  candidate  unallocated  flown")
    ticks = lines[head + 1 : -2]
    assert [line.split()[0] for line in ticks] == [str(step) for step in range(7)]
    assert any("a new leg" in line for line in ticks)
    assert "the tail: the mission is at its end" in ticks[-1]


def test_a_flight_is_written_verified_and_drawn(run: Run, plan: Path, tmp_path: Path) -> None:
    flown = run("fly", plan, "--replan", "none", "--missions", 2, "-o", "a.jsonl")
    assert flown.exit_code == 0
    assert flown.stdout.splitlines()[-1] == "flight written to a.jsonl"
    held = run("verify", "a.jsonl")
    assert held.exit_code == 0
    assert held.stdout.splitlines()[-1].split() == ["the", "flight", "holds"]
    assert "recomputed, 14 ticks" in held.stdout
    text = (tmp_path / "a.jsonl").read_text(encoding="utf-8")
    (tmp_path / "a.jsonl").write_text(text.replace('"excess": 0.0', '"excess": 1.0', 1))
    broken = run("verify", "a.jsonl")
    assert broken.exit_code == 1
    assert "line 2 of the file is not as it was written" in broken.stdout
    told = json.loads(run("verify", "a.jsonl", "--json").stdout)
    assert told["holds"] is False
    assert told["problems"] == [
        "line 2 of the file is not as it was written",
        "mission 1, step 0: states a saturation of 1.0, recomputed it is 0",
    ]
    refused = run("verify", "a.jsonl", "--avoidance", "steps")
    assert refused.exit_code == 2
    assert assert_one_line(refused.stderr) == (
        "radmpc: --avoidance is for plans, and a.jsonl is a flight"
    )


@pytest.mark.slow
def test_a_flight_is_drawn_and_filmed(
    run: Run, plan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film, "FRAMES_PER_STEP", 1)
    words = ("--replan", "none", "--missions", 2, "-o", "a.jsonl", "--film", "a.gif")
    assert run("fly", plan, *words).stdout.splitlines()[-1] == "film written to a.gif"
    assert (tmp_path / "a.gif").read_bytes()[:4] == b"GIF8"
    assert run("draw", "a.jsonl", "-o", "a.png").exit_code == 0
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    refused = run("draw", "a.jsonl", "--view", "risk", "-o", "b.png")
    line = assert_one_line(refused.stderr)
    assert (refused.exit_code, line) == (
        2,
        "radmpc: --view is for plans, and a.jsonl is a flight",
    )


@pytest.mark.slow
def test_what_is_flown_can_be_identified(run: Run, plan: Path, tmp_path: Path) -> None:
    words = ("--replan", "none", "--missions", 10, "--log", "a.mcap")
    assert run("fly", plan, *words).exit_code == 0
    found = json.loads(run("identify", "a.mcap", "--json").stdout)
    assert found["evidence"] == "commands"
    assert found["dt"] == 1.0


def interrupted_at(monkeypatch: pytest.MonkeyPatch, when: tuple[int, int]) -> None:
    """Press Ctrl-C in the middle of a flight."""
    usual = flying._Progress.__call__

    def told(self: object, mission: int, step: int) -> None:
        usual(self, mission, step)
        if (mission, step) == when:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(flying._Progress, "__call__", told)


def test_ctrl_c_keeps_what_was_flown_and_the_flight_goes_on(
    run: Run, plan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("fly", plan, "--replan", "none", "--missions", 3)
    with monkeypatch.context() as patch:
        interrupted_at(patch, (1, 2))
        result = run(*words, "-o", "a.jsonl", "--json")
    assert result.exit_code == 0
    assert "interrupted: 1 of 3 missions are over; go on with 'radmpc fly a.jsonl'" in result.stderr
    assert json.loads(result.stdout)["missions"] == 1
    assert len(load_flight(tmp_path / "a.jsonl").rows) == 10
    refused = run(*words, "-o", "a.jsonl")
    assert refused.exit_code == 2
    assert "it holds a flight that is not over" in assert_one_line(refused.stderr)
    for extra in (("--seed", 1), ("-o", "b.jsonl"), ("--missions", 4)):
        other = run("fly", "a.jsonl", *extra)
        assert other.exit_code == 2
        assert f"{extra[0]} cannot be given: a.jsonl is a flight" in assert_one_line(other.stderr)
    on = run("fly", "a.jsonl", "--json")
    assert (on.exit_code, json.loads(on.stdout)["missions"]) == (0, 3)
    assert run(*words, "-o", "b.jsonl").exit_code == 0
    one, two = (load_flight(tmp_path / f"{name}.jsonl") for name in "ab")
    assert [row.bank for row in one.rows] == [row.bank for row in two.rows]
    assert run(*words, "-o", "a.jsonl").exit_code == 0  # it is over


def test_ctrl_c_before_any_mission_is_over_is_a_no(
    run: Run, plan: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    interrupted_at(monkeypatch, (0, 1))
    result = run("fly", plan, "--replan", "none", "--json")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == "radmpc: interrupted: 0 of 1 missions are over"
    assert json.loads(result.stdout)["rate"] is None
    answer = "radmpc: finishing this tick, what was flown is kept; Ctrl-C again stops at once\n"
    assert capfd.readouterr().err == answer


class Wreck(Model):
    """A backend in which everything is hit."""

    def __init__(self, scenario: object, rng: object, sea: str) -> None:
        super().__init__(scenario, rng)
        if sea != "rough":
            raise RadmpcError(f"sea must be rough, got {sea!r}")

    def advance(self, segments: object) -> tuple[object, tuple[Contact, ...]]:
        states, _ = super().advance(segments)
        return states, (Contact(self._step, "pair", "east", "west"),)


@pytest.fixture
def wreck(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("wrecks")
    monkeypatch.setattr(module, "Wreck", Wreck, raising=False)
    monkeypatch.setitem(sys.modules, "wrecks", module)
    kind = BackendKind("wreck", "wrecks:Wreck", None, "")
    monkeypatch.setattr(backends, "BACKENDS", {"model": backends.BACKENDS["model"], "wreck": kind})


@pytest.mark.usefixtures("wreck")
def test_a_rate_that_speaks_against_the_bound_is_a_no(run: Run, plan: Path) -> None:
    words = ("fly", plan, "--with", "wreck", "--replan", "none", "--missions", 4)
    result = run(*words, "--option", "sea=rough", "-o", "a.jsonl")
    assert result.exit_code == 1
    assert "4 of 4 missions collide: 1 (0.3976 to 1 with" in result.stdout
    assert "east and west (4)" in result.stdout
    assert assert_one_line(result.stderr) == (
        "radmpc: the collision rate is at least 0.3976 with 97.5 % confidence, above the risk "
        "bound 0.05"
    )
    assert run("verify", "a.jsonl").exit_code == 1
    for wrong, line in (
        ("sea=calm", "radmpc: sea must be rough, got 'calm'"),
        ("sea", "radmpc: --option must be KEY=VALUE, every key once, got 'sea'"),
    ):
        refused = run(*words, "--option", wrong)
        assert (refused.exit_code, assert_one_line(refused.stderr)) == (2, line)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--with", "kite"], "--with: backend must be one of model, rotorpy, irsim, boat, mavlink"),
        (["--option", "wind=3"], "backend 'model' takes no option 'wind', got '3'"),
        (["--option", "rng=3"], "backend 'model' takes no option 'rng', got '3'; it takes none"),
        (["--replan", "magic"], "--replan: planner must be one of milp, "),
        (["--log", "a.bag"], "a.bag: a log must end in .mcap"),
        (["--film", "a.png"], "a.png: a film must end in .gif, .mp4"),
        (["--missions", "0"], "--missions"),
        (["--deadline", "inf"], "--deadline must be finite, got inf; without it"),
        (["--with", "boat"], "crossing.plan.json: avoidance: must be 'intervals' to be flown with"),
        (["-o", "crossing.plan.json"], "it is what is read"),
        (["-o", "none/a.jsonl"], "cannot write none/a.jsonl"),
    ],
)
def test_wrong_options_are_refused_before_anything_is_flown(
    run: Run, plan: Path, words: list[str], line: str
) -> None:
    result = run("fly", plan.name, *words)
    assert result.exit_code == 2
    assert line in assert_one_line(result.stderr)


def test_a_log_without_its_library_is_refused_at_once(
    run: Run, plan: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    result = run("fly", plan, "--log", "a.mcap")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert line == "radmpc: a log needs mcap: pip install 'radmpc[mcap]'"


def test_what_is_no_plan_or_above_its_bound_is_not_flown(
    run: Run, plan: Path, crossing: Path, tmp_path: Path
) -> None:
    scenario = run("fly", crossing)
    assert scenario.exit_code == 2
    assert "is a scenario, not a plan: plan it first" in assert_one_line(scenario.stderr)
    content = json.loads(plan.read_text(encoding="utf-8"))
    content["scenario"]["risk_bound"] = 1e-9
    (tmp_path / "risky.json").write_text(json.dumps(content), encoding="utf-8")
    risky = run("fly", "risky.json", "-o", "a.jsonl")
    assert risky.exit_code == 1
    line = assert_one_line(risky.stderr)
    assert line.startswith("radmpc: risky.json: cannot be flown: its certificate of 0.0")
    assert line.endswith(" is above the risk bound of 1e-09")
    assert not (tmp_path / "a.jsonl").exists()
    content["vehicles"].pop()
    (tmp_path / "short.json").write_text(json.dumps(content), encoding="utf-8")
    short = run("fly", "short.json")
    assert short.exit_code == 1
    assert "short.json: cannot be flown: vehicle 'west': missing" in assert_one_line(short.stderr)


def test_visits_are_planned_anew_and_flown_as_they_are(run: Run, plan: Path) -> None:
    told = json.loads(plan.read_text(encoding="utf-8"))
    told["scenario"]["vehicles"][0]["via"] = [{"center": [5, 5], "half_width": 9}]
    plan.write_text(json.dumps(told), encoding="utf-8")
    for how in ("certified", "none"):
        flown = run("fly", plan, "--replan", how)
        assert flown.exit_code == 0, flown.output
