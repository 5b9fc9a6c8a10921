"""Visits in what is exported, by the bytes alone."""

from __future__ import annotations

import json
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from exported_plans import HARBOR, contents, plan_of

from radmpc.model.visits import Visit

NAMESPACE = {"kml": "http://www.opengis.net/kml/2.2"}


def exported(kind: str) -> bytes:
    """Return the tug's part of a plan in which it visits where it is at steps 2 and 4."""
    planned = plan_of(HARBOR)
    means = planned.trajectories[0].means
    via = tuple(Visit.at(means[k, :2], 1.0, between=[k, k]) for k in (2, 4))
    missed = Visit.at(means[5, :2] + 500.0, 1.0, between=[5, 5])
    first = replace(planned.scenario.vehicles[0], via=(*via, missed))
    scenario = replace(planned.scenario, vehicles=(first, *planned.scenario.vehicles[1:]))
    return next(iter(contents(replace(planned, scenario=scenario), kind).values()))


def test_maps_show_visits_with_their_times() -> None:
    features = json.loads(exported("geojson"))["features"]
    visits = [f for f in features if f["properties"]["kind"] == "visit"]
    told = [{k: f["properties"].get(k) for k in ("name", "number", "step", "time")} for f in visits]
    assert told == [
        {"name": "tug", "number": 0, "step": 2, "time": 40.0},
        {"name": "tug", "number": 1, "step": 4, "time": 80.0},
        {"name": "tug", "number": 2, "step": None, "time": None},
    ]
    assert {f["geometry"]["type"] for f in visits} == {"Polygon"}


def test_google_earth_shows_visits_with_their_times() -> None:
    root = ElementTree.fromstring(exported("kml"))
    every = root.iter(f"{{{NAMESPACE['kml']}}}Placemark")
    marks = {mark.findtext("kml:name", None, NAMESPACE): mark for mark in every}
    when = [
        marks[f"tug: visit {k}"].findtext("kml:TimeStamp/kml:when", None, NAMESPACE)
        for k in (1, 2, 3)
    ]
    assert when == ["1970-01-01T00:00:40.000000Z", "1970-01-01T00:01:20.000000Z", None]
    assert marks["tug: visit 2"].find("kml:Polygon", NAMESPACE) is not None


def test_missions_say_which_item_is_a_visit() -> None:
    content = json.loads(exported("qgc"))
    items = {item["doJumpId"]: item for item in content["mission"]["items"]}
    told = content["radmpc"]["visits"]
    when = [(one["visit"], one["step"], one["time"]) for one in told]
    assert when == [(0, 2, 40.0), (1, 4, 80.0)]
    assert all(items[one["item"]]["command"] == 16 for one in told)
    text = exported("waypoints").decode().splitlines()
    comments = [line for line in text if line.startswith("# line")]
    assert comments == [
        f"# line {one['item']} is visit {one['visit'] + 1} at {one['time']:g} s" for one in told
    ]
    rows = [line for line in text[1:] if not line.startswith("#")]
    for one in told:
        latitude = float(rows[one["item"]].split("\t")[8])
        assert latitude == pytest.approx(items[one["item"]]["params"][4], abs=1e-9)
