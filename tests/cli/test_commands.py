from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from radmpc.cli import app
from radmpc.importing.formats import ImportedScenario
from radmpc.io.native.scenario_file import load_scenario
from radmpc.planners.presets import DEFAULT, PRESETS
from radmpc.version import __version__

from .conftest import CROSSING, Run, assert_one_line


def test_the_version_is_that_of_the_package(run: Run) -> None:
    result = run("--version")
    assert result.exit_code == 0
    assert result.stdout == f"radmpc {__version__}\n"


def test_help_lists_every_command(run: Run) -> None:
    result = run("--help")
    assert result.exit_code == 0
    for command in (
        "plan", "check", "compare", "export", "reproduce", "verify", "planners", "import", "demo",
        "identify", "fly",
    ):  # fmt: skip
        assert f"\n  {command} " in result.stdout


def test_a_folder_is_no_file_to_serve(run: Run, tmp_path: Path) -> None:
    result = run("serve", str(tmp_path))
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert f"{tmp_path}: is a folder, not a file: use --folder" in line


@pytest.mark.parametrize("words", [[], ["fly"], ["check"], ["plan", "a", "b"], ["--wrong"]])
def test_wrong_usage_is_one_line_that_points_to_help(run: Run, words: list[str]) -> None:
    result = run(*words)
    assert result.exit_code == 2
    assert "--help" in assert_one_line(result.stderr)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["plan", "a.yaml", "--time-limit", "nan"], "'--time-limit': must be at least 0, got nan"),
        (["plan", "a.yaml", "--jobs", "0"], "'--jobs': must be at least 1, got 0"),
        (["plan", "a.yaml", "--jobs", "two"], "'--jobs': must be a whole number, got two"),
        (["plan", "a.yaml", "--gap", ""], "'--gap': must be a number, got ''"),
        (["plan", "a.yaml", "--seed", "-1"], "'--seed': must be at least 0, got -1"),
        (["verify", "a.json", "--samples", "0"], "'--samples': must be at least 1, got 0"),
        (["serve", "--port", "99999"], "'--port': must be at most 65535, got 99999"),
        (["reproduce", "--seeds", "0"], "'--seeds': must be at least 1, got 0"),
        (["fly", "a.json", "--deadline", "nan"], "'--deadline': must be at least 0, got nan"),
    ],
)
def test_a_value_that_an_option_does_not_take_is_told_with_what_is_allowed(
    run: Run, words: list[str], told: str
) -> None:
    result = run(*words)
    assert result.exit_code == 2
    assert told in assert_one_line(result.stderr)


@pytest.mark.parametrize("option", ["-v", "--jobs"])
def test_an_option_before_its_command_is_told_its_place(run: Run, option: str) -> None:
    result = run(option, "plan", "a.yaml")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert re.search(rf"Option {option} belongs after the command: '\w+ plan {option}'", line)


@pytest.mark.parametrize("words", [["-v"], ["-v", "verify"], ["--hue", "plan"]])
def test_an_option_that_no_command_on_the_line_has_is_not_sent_after_it(
    run: Run, words: list[str]
) -> None:
    assert f"No such option: {words[0]}" in assert_one_line(run(*words).stderr)


def test_check_accepts_a_valid_scenario(run: Run, crossing: Path) -> None:
    result = run("check", crossing)
    assert result.exit_code == 0
    expected = "valid: crossing: 2 vehicles, 1 obstacle, 6 steps of 1 s, risk bound 0.05"
    assert result.stdout.startswith(expected)


def test_check_names_file_and_field_of_an_error(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(CROSSING.replace("radius: 0.4", "radius: -0.4"), encoding="utf-8")
    result = run("check", path)
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert "bad.yaml" in line
    assert "radius" in line


def test_planners_lists_every_preset_with_its_summary(run: Run) -> None:
    result = run("planners")
    assert result.exit_code == 0
    for preset in PRESETS.values():
        assert preset.name in result.stdout
        assert preset.summary in result.stdout
    assert f"{DEFAULT} (default)" in result.stdout


def test_planners_as_json_is_one_object(run: Run) -> None:
    content = json.loads(run("planners", "--json").stdout)
    assert content["default"] == DEFAULT
    assert [entry["name"] for entry in content["planners"]] == list(PRESETS)
    assert set(content["planners"][0]) == {
        "name", "policy", "solver", "decomposition", "summary"
    }  # fmt: skip


@pytest.mark.slow
def test_the_demo_plans_draws_and_says_what_next(run: Run) -> None:
    result = run("demo", "--out", "made/here")
    assert result.exit_code == 0, result.stderr
    names = {path.name for path in Path("made/here").iterdir()}
    assert names == {"harbor.yaml", "harbor.plan.json", "harbor.png"}
    assert "within the bound 0.05" in result.stdout
    assert "radmpc verify made/here/harbor.plan.json" in result.stdout
    fly = "radmpc fly made/here/harbor.plan.json -o made/here/harbor.flight.jsonl"
    assert fly in result.stdout


def test_the_demo_refuses_a_file_as_its_folder(run: Run) -> None:
    Path("taken").write_text("", encoding="utf-8")
    result = run("demo", "--out", "taken")
    assert result.exit_code == 2
    assert assert_one_line(result.stderr) == "radmpc: cannot write taken: File exists"


def test_the_guard_returns_the_code_where_no_exit_is_wanted() -> None:
    from typer.main import get_command  # noqa: PLC0415 - only this test looks below typer

    assert get_command(app).main(["planners", "--json"], standalone_mode=False) == 0


SWAP = """\
environment:
  min: [0, 0]
  max: [10, 5]
  obstacles: []
robots:
  - {type: double_integrator_0, start: [2, 2.5, 0, 0], goal: [8, 2.5, 0, 0]}
  - {type: double_integrator_0, start: [8, 2.5, 0, 0], goal: [2, 2.5, 0, 0]}
"""


def test_import_prints_what_it_chose_and_writes_a_valid_scenario(run: Run, tmp_path: Path) -> None:
    (tmp_path / "swap.yaml").write_text(SWAP, encoding="utf-8")
    result = run("import", "swap.yaml", "-o", "mine.yaml", "--risk-bound", 0.01, "--horizon", 50)
    assert result.exit_code == 0, result.stderr
    assert "2 vehicles, 0 obstacles, 50 steps" in result.stdout
    assert "noise" in result.stdout
    assert "scenario written to mine.yaml" in result.stdout
    checked = run("check", "mine.yaml")
    assert checked.exit_code == 0
    assert "risk bound 0.01" in checked.stdout


def test_every_error_of_a_file_has_its_line_on_stderr(run: Run, crossing: Path) -> None:
    text = crossing.read_text(encoding="utf-8")
    crossing.write_text(text.replace("dt: 1.0", "dt: -1").replace("0.05\n", "0.7\n", 1))
    result = run("check", crossing)
    assert result.exit_code == 2
    assert [line.split(": ", 2)[1:] for line in result.stderr.splitlines()] == [
        [f"{crossing}:3", "dt: must be > 0 s, got -1.0"],
        [f"{crossing}:5", "risk_bound: must lie between 0 and 0.5, both excluded, got 0.7"],
    ]


def test_import_says_as_check_does_where_discs_overlap_at_starts_or_goals(
    run: Run, tmp_path: Path
) -> None:
    robot = "  - {type: car_first_order_with_1_trailers_0, start: [%s], goal: [%s]}\n"
    (tmp_path / "cars.yaml").write_text(
        "environment: {min: [0, 0], max: [5, 5]}\nrobots:\n"
        + robot % ("1, 1, 0, 0", "4, 1, 0, 0")
        + robot % ("1, 2, 0, 0", "4, 4, 0, 0"),
        encoding="utf-8",
    )
    imported = run("import", "cars.yaml", "-o", "mine.yaml", "--radius", 0.662)
    assert imported.exit_code == 0
    (told,) = [line for line in imported.stdout.splitlines() if line.startswith("no plan: ")]
    assert "they overlap, 1 m apart where 1.32 m" in told
    assert told.split(" What helps")[0] in run("check", "mine.yaml").stdout.replace("\n", " ")


def test_import_takes_as_many_vehicles_as_are_asked_for(run: Run, tmp_path: Path) -> None:
    (tmp_path / "swap.yaml").write_text(SWAP, encoding="utf-8")
    result = run("import", "swap.yaml", "-o", "mine.yaml", "--agents", 1)
    assert result.exit_code == 0, result.stderr
    assert "the first 1 of 2, as asked" in result.stdout
    assert len(load_scenario(tmp_path / "mine.yaml").vehicles) == 1


def test_import_tells_its_warnings(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    imported = ImportedScenario(load_scenario(crossing), {"dt": "1 s"}, ("no cars here",))
    monkeypatch.setattr("radmpc.importing.import_scenario", lambda source, options: imported)
    result = run("import", "any", "-o", "mine.yaml")
    assert "warning: no cars here" in result.stdout


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--dt", "-1"], "radmpc: --dt must be > 0 s, got -1.0"),
        (["--risk-bound", "0.7"], "radmpc: --risk-bound must lie between 0 and 0.5"),
        (["--agents", "3"], "agents: must be at most 2, got 3"),
        (["--avoidance", "sometimes"], "radmpc: --avoidance must be 'steps' or 'intervals'"),
        (["-o", "no/mine.yaml"], "cannot write no/mine.yaml: no: No such file"),
    ],
)
def test_import_refuses_bad_choices(
    run: Run, tmp_path: Path, words: list[str], expected: str
) -> None:
    (tmp_path / "swap.yaml").write_text(SWAP, encoding="utf-8")
    result = run("import", "swap.yaml", "-o", "mine.yaml", *words)
    assert result.exit_code == 2
    assert expected in assert_one_line(result.stderr)
