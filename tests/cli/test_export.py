from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path

import pytest

from radmpc.io.export import ros2

from .conftest import Run, assert_one_line

ORIGIN = ("--origin", "54.1,12.1,30")
FORMATS = [
    "qgc",
    "waypoints",
    "geojson",
    "kml",
    "csv",
    *(["mcap"] if find_spec("mcap_ros2") else []),
]


@pytest.fixture
def plan_file(crossing: Path, crossing_plan: bytes) -> Path:
    """A certified plan of two vehicles."""
    path = crossing.with_name("crossing.plan.json")
    path.write_bytes(crossing_plan)
    return path


def claim(path: Path, **claims: object) -> None:
    """Change what a plan file holds."""
    content = json.loads(path.read_text(encoding="utf-8")) | claims
    path.write_text(json.dumps(content), encoding="utf-8")


def test_a_flight_is_named_as_one(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "x.flight.jsonl"
    path.write_text('{"format": "radmpc/flight/1"}\n{"step": 0}\n', encoding="utf-8")
    result = run("export", path, "--to", "csv", "-o", tmp_path / "x.csv")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert "x.flight.jsonl: is a flight, not a plan: give the plan that was flown" in line


@pytest.mark.parametrize("to", [name for name in FORMATS if name not in {"qgc", "waypoints"}])
def test_a_fleet_goes_into_one_file(run: Run, plan_file: Path, to: str) -> None:
    words = () if to == "csv" else ORIGIN
    result = run("export", plan_file, "--to", to, "-o", "fleet.out", *words)
    assert result.exit_code == 0, result.stderr
    assert result.stdout == "plan written to fleet.out\n"
    assert result.stderr == ""
    first = Path("fleet.out").read_bytes()
    assert run("export", plan_file, "--to", to, "-o", "fleet.out", *words).exit_code == 0
    assert Path("fleet.out").read_bytes() == first


@pytest.mark.parametrize("to", ["qgc", "waypoints"])
def test_waypoints_go_into_a_file_per_vehicle_with_one_warning(
    run: Run, plan_file: Path, to: str
) -> None:
    result = run("export", plan_file, "--to", to, "-o", "fleet.plan", *ORIGIN)
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [
        "plan of east written to fleet.east.plan",
        "plan of west written to fleet.west.plan",
    ]
    assert assert_one_line(result.stderr) == (
        "radmpc: warning: waypoints carry no time: the risk bound 0.05 holds only if all vehicles "
        "keep the plan's timing"
    )
    assert not Path("fleet.plan").exists()
    assert Path("fleet.east.plan").read_bytes() != Path("fleet.west.plan").read_bytes()


@pytest.mark.parametrize("device", ["/dev/null", "/dev/stdout"])
def test_a_file_per_vehicle_is_not_written_beside_a_device(
    run: Run, plan_file: Path, device: str
) -> None:
    if not Path(device).exists():
        pytest.skip("no such device here")
    result = run("export", plan_file, "--to", "qgc", "-o", device, *ORIGIN)
    assert result.exit_code == 2
    assert assert_one_line(result.stderr) == (
        f"radmpc: cannot write {device}: qgc makes a file for each of 2 vehicles, and this is "
        "a stream or a device: name a file, as -o fleet.plan"
    )
    assert list(Path("/dev").glob(f"{Path(device).name}.*")) == []


def test_without_a_place_on_earth_maps_are_refused(run: Run, plan_file: Path) -> None:
    for to in ("qgc", "waypoints", "geojson", "kml"):
        result = run("export", plan_file, "--to", to, "-o", "out")
        assert result.exit_code == 2
        assert "radmpc: --origin is required" in assert_one_line(result.stderr)
    assert not Path("out").exists()


def test_the_place_noted_in_the_scenario_will_do(run: Run, plan_file: Path) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    place = {"latitude": 54.1, "longitude": 12.1, "height": 30}
    claim(plan_file, scenario=content["scenario"] | {"source": {"origin": place}})
    assert run("export", plan_file, "--to", "kml", "-o", "noted.kml").exit_code == 0
    assert run("export", plan_file, "--to", "kml", "-o", "given.kml", *ORIGIN).exit_code == 0
    assert Path("noted.kml").read_bytes() == Path("given.kml").read_bytes()


def test_southern_latitudes_can_be_typed(run: Run, plan_file: Path) -> None:
    words = ("--origin", "-33.8,151.2")
    assert run("export", plan_file, "--to", "geojson", "-o", "s.json", *words).exit_code == 0
    assert "-33.8" in Path("s.json").read_text(encoding="utf-8")


def test_steps_are_left_out_within_a_tolerance_and_that_is_told(run: Run, plan_file: Path) -> None:
    words = ("--to", "geojson", *ORIGIN)
    assert run("export", plan_file, *words, "-o", "all.json").exit_code == 0
    # The plan itself spends all of its bound of 0.05.
    thinned = ("--tolerance", "0.5", "--risk-bound", "0.1")
    result = run("export", plan_file, *words, "-o", "few.json", *thinned)
    assert result.exit_code == 0, result.stderr
    few, whole = (json.loads(Path(f).read_text(encoding="utf-8")) for f in ("few.json", "all.json"))
    assert "with a risk of at most" in few["steps"]
    assert few["steps"] in " ".join(result.stdout.split())
    counts = [
        sum(len(f["properties"].get("times", ())) for f in content["features"])
        for content in (few, whole)
    ]
    assert counts[0] < counts[1]


def test_steps_of_a_plan_above_its_bound_all_stay(run: Run, plan_file: Path) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    claim(plan_file, scenario=content["scenario"] | {"risk_bound": 1e-9})
    words = ("--to", "geojson", *ORIGIN, "--tolerance", "0.5")
    result = run("export", plan_file, *words, "-o", "all.json")
    assert result.exit_code == 0
    assert "NOT certified" in json.loads(Path("all.json").read_text(encoding="utf-8"))["steps"]
    assert "warning" in assert_one_line(result.stderr)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--to", "shp", "-o", "x", *ORIGIN), "--to must be one of"),
        (("--to", "kml", "-o", "x", "--origin", "north"), "--origin must be LAT,LON"),
        (("--to", "kml", "-o", "x", "--origin", "95,0"), "latitude: must lie"),
        (("--to", "csv", "-o", "x", *ORIGIN), "--origin does not fit csv"),
        (("--to", "csv", "-o", "x", "--altitude", "3"), "--altitude does not fit csv"),
        (("--to", "kml", "-o", "x", *ORIGIN, "--risk-bound", "0.1"), "needs --tolerance"),
        (
            ("--to", "kml", "-o", "x", *ORIGIN, "--tolerance", "1", "--risk-bound", "2"),
            "--risk-bound must",
        ),
        (("--to", "csv", "-o", "x", "--tolerance", "1"), "--tolerance does not fit csv"),
        (("--to", "kml", "-o", "x", *ORIGIN, "--tolerance", "0"), "--tolerance must be a number"),
        (("--to", "csv", "-o", "missing/x"), "missing"),
        (("--to", "csv"), "--output"),
        (("-o", "x"), "--to"),
    ],
)
def test_wrong_words_are_one_line(
    run: Run, plan_file: Path, words: tuple[str, ...], expected: str
) -> None:
    result = run("export", plan_file, *words)
    assert result.exit_code == 2
    assert expected in assert_one_line(result.stderr)
    assert not Path("x").exists()


def test_a_file_without_a_plan_has_nothing_to_export(run: Run, infeasible: Path) -> None:
    run("plan", infeasible, "-o", "none.json")
    result = run("export", "none.json", "--to", "csv", "-o", "out.csv")
    assert result.exit_code == 1
    assert "cannot reach its goal" in assert_one_line(result.stderr)
    assert not Path("out.csv").exists()


def test_a_plan_above_its_bound_is_written_with_a_warning(run: Run, plan_file: Path) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    claim(plan_file, scenario=content["scenario"] | {"risk_bound": 1e-9}, risk=content["risk"])
    result = run("export", plan_file, "--to", "kml", "-o", "out.kml", *ORIGIN)
    assert result.exit_code == 0
    assert "warning: the plan" in assert_one_line(result.stderr)
    assert "NOT certified" in Path("out.kml").read_text(encoding="utf-8")


def test_a_plan_that_was_tampered_with_is_found_out(run: Run, plan_file: Path) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    content["vehicles"][0]["means"][3][1] += 0.5
    claim(plan_file, vehicles=content["vehicles"])
    result = run("export", plan_file, "--to", "csv", "-o", "out.csv")
    assert result.exit_code == 0
    line = assert_one_line(result.stderr)
    assert "warning: the plan does not hold" in line
    assert "east" in line


def test_arrays_that_do_not_fit_are_refused(run: Run, plan_file: Path) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    content["vehicles"][0]["means"].pop()
    claim(plan_file, vehicles=content["vehicles"])
    result = run("export", plan_file, "--to", "csv", "-o", "out.csv")
    assert result.exit_code == 2
    assert "vehicles[0].means" in assert_one_line(result.stderr)


def test_the_plan_itself_is_not_written_over(run: Run, plan_file: Path) -> None:
    before = plan_file.read_bytes()
    result = run("export", plan_file, "--to", "csv", "-o", plan_file)
    assert result.exit_code == 2
    assert "it is the plan itself" in assert_one_line(result.stderr)
    assert plan_file.read_bytes() == before


def test_a_missing_library_is_one_line(
    run: Run, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(ros2, "import_module", missing)
    result = run("export", plan_file, "--to", "mcap", "-o", "out.mcap")
    assert result.exit_code == 2
    assert "pip install 'radmpc[mcap]'" in assert_one_line(result.stderr)
    assert not Path("out.mcap").exists()


def test_what_is_no_plan_is_one_line(run: Run, crossing: Path) -> None:
    result = run("export", crossing, "--to", "csv", "-o", "out.csv")
    assert result.exit_code == 2
    assert "crossing.yaml" in assert_one_line(result.stderr)


def test_a_plan_that_leaves_the_earth_is_refused_with_its_file(
    run: Run, crossing_plan: bytes
) -> None:
    content = json.loads(crossing_plan)
    content["vehicles"][0]["means"][3][0] = 1e300
    Path("a.json").write_text(json.dumps(content), encoding="utf-8")
    result = run("export", "a.json", "--to", "qgc", "--origin", "54,12", "-o", "out.plan")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert line.startswith("radmpc: a.json: the plan reaches 1e+300 m from its origin")
