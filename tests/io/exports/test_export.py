from __future__ import annotations

import json
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_plans import FLIGHT, HARBOR, ORIGIN, contents, plan_of, renamed

from radmpc.errors import NoPlanError, ScenarioError
from radmpc.geodesy import Origin
from radmpc.io.export.exporting import FORMATS, ExportOptions, export_plan, save_exported
from radmpc.io.export.names import distinct, file_part, topic_part
from radmpc.io.export.origin import parse_origin, scenario_origin
from radmpc.io.native.plan_file import load_plan, save_plan
from radmpc.model.dynamics import LinearSystem
from radmpc.model.plan import Plan, Trajectory

HAS_MCAP = find_spec("mcap_ros2") is not None
WRITABLE = [name for name in FORMATS if name != "mcap" or HAS_MCAP]
ON_EARTH = ["qgc", "waypoints", "geojson", "kml"]
PLACE = {"latitude": 54.1234, "longitude": 12.0987, "height": 38.25}


def refusal(plan: Plan, to: str, **options: Any) -> str:
    """The line that refuses an export."""
    with pytest.raises(ScenarioError) as caught:
        export_plan(plan, to, "out", ExportOptions(**options))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("to", WRITABLE)
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_the_same_plan_gives_the_same_bytes(
    to: str, content: dict[str, Any], tmp_path: Path
) -> None:
    plan = plan_of(content)
    save_plan(plan, tmp_path / "plan.json")
    again = load_plan(tmp_path / "plan.json")
    assert contents(plan, to) == contents(again, to) == contents(again, to)


@pytest.mark.parametrize("to", ON_EARTH)
def test_a_map_needs_a_place_on_earth(to: str) -> None:
    line = refusal(plan_of(HARBOR), to)
    assert "no place on earth" in line
    assert line.startswith("origin: is required")


@pytest.mark.parametrize("to", ON_EARTH)
def test_the_place_an_importer_noted_is_as_good_as_one_given(to: str) -> None:
    noted = plan_of(HARBOR, source={"format": "chart", "origin": PLACE})
    found = export_plan(noted, to, f"fleet.{to}").files
    assert {path.name: data for path, data in found.items()} == contents(plan_of(HARBOR), to)


def test_a_place_that_is_given_goes_before_one_noted() -> None:
    noted = plan_of(HARBOR, source={"origin": {"latitude": 1.0, "longitude": 2.0}})
    assert contents(noted, "kml") == contents(plan_of(HARBOR), "kml")


@pytest.mark.parametrize(
    ("noted", "expected"),
    [
        ("here", "scenario.source.origin: must be a mapping"),
        ({"latitude": 1.0}, "scenario.source.origin.longitude: must be a number, got null"),
        (PLACE | {"latitude": True}, "scenario.source.origin.latitude: must be a number, got true"),
        (PLACE | {"longitude": 200.0}, "scenario.source.origin.longitude: must lie between"),
        (PLACE | {"height": 10**300}, "scenario.source.origin.height: must lie between"),
    ],
)
def test_a_noted_place_that_is_none_is_named(noted: object, expected: str) -> None:
    assert expected in refusal(plan_of(HARBOR, source={"origin": noted}), "kml")


def test_a_noted_place_may_lack_its_height() -> None:
    plan = plan_of(HARBOR, source={"origin": {"latitude": 1, "longitude": 2}})
    assert scenario_origin(plan.scenario) == Origin(1.0, 2.0, 0.0)
    assert scenario_origin(plan_of(HARBOR, source={"format": "x"}).scenario) is None


def test_origins_are_read_as_they_are_typed() -> None:
    assert parse_origin("54.1234, 12.0987,38.25") == ORIGIN
    assert parse_origin("-33.8,151.2") == Origin(-33.8, 151.2, 0.0)


@pytest.mark.parametrize("text", ["", "1", "1,2,3,4", "a,b", "1,nan", "inf,1", "91,0", "1;2"])
def test_what_is_no_place_is_refused_by_its_name(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"^origin"):
        parse_origin(text)


def test_unknown_formats_are_refused_with_the_known_ones() -> None:
    line = refusal(plan_of(HARBOR), "shp")
    assert line == "to: must be one of qgc, waypoints, geojson, kml, mcap, csv, got 'shp'"


@pytest.mark.parametrize("to", FORMATS)
def test_a_file_without_a_plan_has_nothing_to_export(to: str) -> None:
    empty = replace(plan_of(HARBOR), trajectories=(), explanation="the tug cannot reach its goal")
    with pytest.raises(NoPlanError, match="the tug cannot reach its goal"):
        export_plan(empty, to, "out")


def test_arrays_that_do_not_fit_are_named() -> None:
    plan = plan_of(HARBOR)
    tug, pilot = plan.trajectories
    short = replace(plan, trajectories=(tug, replace(pilot, means=pilot.means[:-1])))
    assert refusal(short, "csv").startswith("vehicles[1].means: must have shape (7, 4), got (6, 4)")
    flat = replace(tug, covariances=np.zeros((7, 2, 2)))
    assert "vehicles[0].covariances" in refusal(replace(plan, trajectories=(flat, pilot)), "csv")
    assert "in its order" in refusal(replace(plan, trajectories=(pilot, tug)), "csv")


def test_options_that_would_do_nothing_are_refused() -> None:
    assert "heights of its own" in refusal(plan_of(FLIGHT), "kml", origin=ORIGIN, altitude=1.0)
    assert "origin: does not fit csv" in refusal(plan_of(HARBOR), "csv", origin=ORIGIN)
    assert "altitude: does not fit csv" in refusal(plan_of(HARBOR), "csv", altitude=1.0)
    assert "altitude: must lie" in refusal(plan_of(HARBOR), "kml", altitude=float("nan"))


@pytest.mark.parametrize("to", ON_EARTH)
def test_a_plan_too_wide_for_a_flat_map_is_refused(to: str) -> None:
    far = HARBOR["vehicles"][0] | {
        "start": [2e5, 0],
        "goal": {"center": [2e5, 0], "half_width": 9e5, "speed": None},
    }
    assert "from its origin" in refusal(plan_of(HARBOR, vehicles=[far]), to, origin=ORIGIN)


def drifting(system: LinearSystem) -> LinearSystem:
    """The same states and controls, without a step of its own."""
    return replace(system, A=np.eye(system.num_states), is_double_integrator=False)


@pytest.mark.parametrize("to", ["kml", *(["mcap"] if HAS_MCAP else [])])
def test_a_mission_too_long_for_a_formats_clock_is_refused(to: str) -> None:
    fast = plan_of(FLIGHT).scenario
    vehicles = [replace(v, system=drifting(v.system)) for v in fast.vehicles]
    steps = 250_000 if to == "kml" else 2_500
    slow = replace(fast, dt=1e6, horizon=steps, vehicles=tuple(vehicles))
    plan = replace(plan_of(FLIGHT), scenario=slow)
    zeros = (np.zeros((steps, 3)), np.zeros((steps + 1, 6)), np.zeros((steps + 1, 6, 6)))
    plan = replace(plan, trajectories=(Trajectory(plan.trajectories[0].name, *zeros),))
    assert "longer than" in refusal(plan, to, origin=ORIGIN)


@pytest.mark.parametrize("to", ["qgc", "waypoints"])
def test_every_vehicle_gets_a_file_and_one_vehicle_the_file_asked_for(to: str) -> None:
    several = export_plan(plan_of(HARBOR), to, "a/fleet.plan", ExportOptions(ORIGIN))
    assert several.vehicles == {
        Path("a/fleet.tug.plan"): "tug",
        Path("a/fleet.pilot_7.plan"): "pilot 7",
    }
    assert list(several.files) == list(several.vehicles)
    single = export_plan(plan_of(FLIGHT), to, "a/fleet.plan", ExportOptions(ORIGIN))
    assert list(single.files) == [Path("a/fleet.plan")]
    assert not single.vehicles


def test_only_waypoints_warn_of_lost_time() -> None:
    for to in WRITABLE:
        options = ExportOptions(None if to == "csv" else ORIGIN)
        warnings = export_plan(plan_of(FLIGHT), to, "out", options).warnings
        assert bool(warnings) is (to in {"qgc", "waypoints"})
    assert export_plan(plan_of(FLIGHT), "qgc", "out", ExportOptions(ORIGIN)).warnings == (
        "waypoints carry no time: the risk bound 0.01 holds only if the vehicle keeps the plan's "
        "timing",
    )


@pytest.mark.parametrize("to", [name for name in WRITABLE if name != "csv"])
@pytest.mark.parametrize("certified", [0.2, None])
def test_a_plan_that_is_not_certified_says_so_in_the_file(to: str, certified: float | None) -> None:
    for content in contents(plan_of(HARBOR, certified), to).values():
        assert b"NOT certified within its risk bound 0.05" in content
    doubted = contents(plan_of(HARBOR), to, is_certified=False)
    assert all(b"NOT certified" in content for content in doubted.values())
    assert all(b"NOT" not in content for content in contents(plan_of(HARBOR), to).values())


def test_no_names_lead_out_of_the_folder_or_onto_each_other() -> None:
    plan = renamed(renamed(plan_of(HARBOR), "tug", "../../x/Y"), "pilot 7", "------x/y")
    files = export_plan(plan, "qgc", "out/f.plan", ExportOptions(ORIGIN)).files
    assert [path.as_posix() for path in files] == ["out/f.______x_Y.plan", "out/f.------x_y.plan"]
    assert distinct(["A b", "a_b", "a/b"], file_part) == {
        "A b": "A_b",
        "a_b": "a_b_2",
        "a/b": "a_b_3",
    }
    assert distinct(["tug", "Tug"], file_part) == {"tug": "tug", "Tug": "Tug_2"}
    assert topic_part("ä") == "vehicle"
    assert topic_part("a__b-1") == "a_b_1"


def test_files_are_written_whole(tmp_path: Path) -> None:
    exported = export_plan(plan_of(HARBOR), "qgc", tmp_path / "f.plan", ExportOptions(ORIGIN))
    save_exported(exported)
    assert {path.name for path in tmp_path.iterdir()} == {"f.tug.plan", "f.pilot_7.plan"}
    for path, content in exported.files.items():
        assert path.read_bytes() == content
        assert json.loads(content)


def test_heights_far_from_the_origin_are_told_to_differ_from_the_plans() -> None:
    options = ExportOptions(ORIGIN)
    near = plan_of(FLIGHT)
    path = near.trajectories[0]
    means = path.means + np.array([10_000.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    far = replace(near, trajectories=(replace(path, means=means),))
    # The ground lies 10 km squared over twice the earth's radius below the plane.
    expected = (
        "heights are up to 7.8 m larger than the plan's z: 9.99 km from its origin the ground "
        "lies as far below its plane"
    )
    for to in ("qgc", "waypoints", "kml"):
        assert expected in export_plan(far, to, "out", options).warnings
        assert expected not in "".join(export_plan(near, to, "out", options).warnings)
    assert export_plan(far, "geojson", "out", options).warnings == ()
    assert len(export_plan(plan_of(HARBOR), "qgc", "out", options).warnings) == 1
