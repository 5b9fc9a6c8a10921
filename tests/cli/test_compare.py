"""Planners side by side, from the command line."""

from __future__ import annotations

import io
import json
import re
from contextlib import nullcontext

import pytest
from rich.console import Console

from radmpc.console.commands import comparing
from radmpc.console.reports.comparison_table import comparison_table, rate_text
from radmpc.console.reports.progress import progress_line
from radmpc.errors import ArgumentError
from radmpc.experiments.comparing import compare
from radmpc.io.native.scenario_file import load_scenario


def test_compare_prints_a_line_per_planner(run, crossing):
    result = run("compare", crossing, "--planners", "dlp, radmpc,certified", "--samples", 5000)
    assert result.exit_code == 0
    lines = {line.split()[0]: line for line in result.stdout.splitlines() if line.strip()}
    assert {"dlp", "radmpc", "certified", "planner"} <= lines.keys()
    assert "+0.00 %" in lines["certified"]
    assert "optimal" in lines["certified"]


@pytest.mark.parametrize("width", [40, 80, 200])
def test_nothing_is_cut_off_however_narrow_the_terminal(crossing, width):
    found = compare(load_scenario(crossing), ("dlp", "multi-vehicle(1e-12)"), rng=0, samples=1000)
    found = list(found)
    buffer = io.StringIO()
    Console(file=buffer, width=width).print(comparison_table(found, width))
    lines = buffer.getvalue().splitlines()
    assert all(len(line.rstrip()) <= width for line in lines)
    words = buffer.getvalue().split()
    for one in found:
        result = one.result
        assert one.planner in " ".join(words)
        for number in (f"{result.cost:.4g}", f"{result.seconds['total']:.2f}"):
            assert number in {word.strip(",") for word in words}
        assert f"{one.simulation.rate:.4g}" in words
    assert "…" not in buffer.getvalue()
    assert (len(lines) == 3) is (width == 200)


def test_compare_gives_the_numbers_as_json(run, crossing):
    result = run(
        "compare", crossing, "--planners", "dlp,certified,distance(3)", "--samples", 5000, "--json"
    )
    content = json.loads(result.stdout)
    found = {one["planner"]: one for one in content["planners"]}
    assert list(found) == ["dlp", "certified", "distance(3)"]
    assert found["certified"]["is_within"]
    assert found["certified"]["rate_low"] <= found["certified"]["certified"]
    assert not found["dlp"]["is_within"]
    assert found["dlp"]["rate"] > 0.05
    assert found["dlp"]["cost"] < found["certified"]["cost"]
    assert found["distance(3)"]["sets"] == [["east", "west"]]


def test_a_planner_that_the_time_limit_cut_off_is_told_from_one_that_ended(run, crossing):
    words = ("compare", crossing, "--planners", "rmpc-rrt,certified", "--samples", 100)
    short = (*words, "--time-limit", 1e-9)
    cut, ended = run(*short).stdout, run(*words).stdout
    assert "limit, time limit" in cut
    assert "time limit" not in ended
    found = {}
    for name, given in (("cut", short), ("ended", words)):
        content = json.loads(run(*given, "--json").stdout)
        found[name] = [one["stopped_by"] for one in content["planners"]]
    assert found["cut"] == ["the time limit of 1e-09 s was reached"] * 2
    assert found["ended"] == [None, None]


def test_a_certificate_above_the_bound_is_marked_without_colors(run, crossing):
    result = run("compare", crossing, "--planners", "dlp,certified", "--samples", 100)
    lines = {line.split()[0]: line for line in result.stdout.splitlines() if line.strip()}
    assert " > 0.05" in lines["dlp"]
    assert " > 0.05" not in lines["certified"]


@pytest.mark.parametrize(
    ("rate", "low", "high", "text"),
    [
        (0.9976, 0.99727, 0.99789, "0.9976 (0.997–0.998)"),
        (0.02505, 0.02301, 0.02713, "0.02505 (0.023–0.027)"),
        (0.0, 0.0, 0.000184, "0 (0–0.00018)"),
        (1.0, 0.999963, 1.0, "1 (0.99996–1)"),
        (0.25004, 0.250031, 0.250049, "0.25004 (0.25003–0.25005)"),
    ],
)
def test_an_interval_is_told_in_digits_in_which_it_holds_the_rate(rate, low, high, text):
    assert rate_text(rate, low, high) == text


@pytest.mark.slow
def test_compare_draws_a_panel_per_planner(run, crossing, tmp_path):
    result = run(
        "compare", crossing, "--planners", "dlp,certified", "--samples", 100, "--figure", "c.svg"
    )
    assert "picture written to c.svg" in result.stdout
    drawn = (tmp_path / "c.svg").read_text(encoding="utf-8")
    assert drawn.count('id="path:east"') == 2


def test_compare_says_no_where_no_planner_has_a_plan(run, infeasible):
    result = run("compare", infeasible, "--planners", "certified,distance", "--samples", 100)
    assert result.exit_code == 1
    assert "certified: " in result.stdout
    assert "infeasible" in result.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--planners", "nobody"], "planner must be one of"),
        (["--planners", ","], "at least one planner"),
        (["--planners", "dlp,dlp"], "twice"),
        (["--planners", "dlp", "--figure", "c.txt"], "a figure must end in"),
        (["--jobs", "2", "--dask", "here"], "exclude each other"),
        (["--samples", str(10**9 + 1)], "samples must be at most 1000000000, got 1000000001"),
    ],
)
def test_compare_refuses_what_cannot_be_in_one_line(run, crossing, words, message):
    result = run("compare", crossing, *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize("samples", [0, 10**9 + 1])
def test_samples_that_cannot_be_flown_are_refused_before_planning(crossing, monkeypatch, samples):
    monkeypatch.setattr("radmpc.experiments.comparing.plan", lambda *_, **__: pytest.fail("plans"))
    with pytest.raises(ArgumentError, match=r"^samples must be .* got "):
        next(compare(load_scenario(crossing), ("dlp",), samples=samples))


@pytest.mark.parametrize(
    ("count", "end"),
    [(1, "planners that had not begun are left out: radmpc"), (2, "every planner had begun")],
)
def test_an_interruption_tells_which_planners_are_left_out(run, crossing, monkeypatch, count, end):
    pressed = []

    def interrupted(scenario, planners, **words):
        yield from compare(scenario, planners[:count], **words)
        pressed.append(True)

    monkeypatch.setattr(comparing, "compare", interrupted)
    monkeypatch.setattr(comparing, "stop_on_interrupt", lambda: nullcontext(lambda: bool(pressed)))
    result = run("compare", crossing, "--planners", "dlp, radmpc", "--samples", 100)
    assert result.stderr.splitlines()[-1] == f"radmpc: interrupted: {end}"


def test_a_terminal_gets_every_planner_when_it_is_done(run, crossing, monkeypatch):
    terminal = io.StringIO()
    seen = []

    def watched(*given, **words):
        for one in compare(*given, **words):
            seen.append(terminal.getvalue())
            yield one

    def drawn():
        return progress_line(Console(file=terminal, force_terminal=True, width=200))

    words = ("compare", crossing, "--planners", "dlp, radmpc", "--samples", 100)
    piped = run(*words)
    monkeypatch.setattr(comparing, "compare", watched)
    monkeypatch.setattr(comparing, "progress_line", drawn)
    result = run(*words)
    assert "cost" not in seen[0]
    assert "dlp" in seen[1]
    assert "feasible, cost " in seen[1]
    assert "radmpc" in terminal.getvalue()
    seconds = re.compile(r"[0-9.]+$", re.MULTILINE)
    assert seconds.sub("", result.stdout) == seconds.sub("", piped.stdout)
    assert piped.stderr == ""


def test_a_planner_alone_is_told_in_the_table_only(run, crossing, monkeypatch):
    terminal = io.StringIO()
    console = Console(file=terminal, force_terminal=True)
    monkeypatch.setattr(comparing, "progress_line", lambda: progress_line(console))
    result = run("compare", crossing, "--planners", "dlp", "--samples", 100)
    assert "cost" in result.stdout
    assert "cost" not in terminal.getvalue()
