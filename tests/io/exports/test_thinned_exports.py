"""Exports of some of a plan's steps."""

from __future__ import annotations

import json
from typing import Any

import pytest
from exported_plans import HARBOR, ORIGIN, plan_of

from radmpc.errors import ScenarioError
from radmpc.io.export.exporting import ExportOptions, export_plan
from radmpc.model.plan import Plan


def first_and_last(plan: Plan) -> dict[str, list[int]]:
    return {t.name: [0, plan.scenario.horizon] for t in plan.trajectories}


def exported(to: str, **options: Any) -> list[str]:
    plan = plan_of(HARBOR)
    chosen = ExportOptions(ORIGIN, steps=first_and_last(plan), **options)
    return [data.decode() for data in export_plan(plan, to, "out", chosen).files.values()]


def test_only_chosen_steps_are_written_with_their_times_and_what_is_said_of_them() -> None:
    plan = plan_of(HARBOR)
    (text,) = exported("geojson", note="two of three")
    content = json.loads(text)
    assert content["steps"] == "two of three"
    end = plan.scenario.horizon * plan.scenario.dt
    paths = [f for f in content["features"] if f["properties"]["kind"] == "path"]
    assert [p["properties"]["times"] for p in paths] == [[0.0, end]] * len(plan.trajectories)
    assert all(len(p["geometry"]["coordinates"]) == 2 for p in paths)
    for text in exported("waypoints", note="two of three"):
        assert "# two of three" in text
    for text in exported("qgc", note="two of three"):
        assert json.loads(text)["radmpc"]["steps"] == "two of three"
    (text,) = exported("kml", note="two of three")
    assert "two of three" in text
    assert text.count("<gx:coord>") == 2 * len(plan.trajectories)


@pytest.mark.parametrize(
    ("to", "steps", "expected"),
    [
        ("csv", {}, "steps: do not fit csv"),
        ("geojson", {}, "is required: the steps of this vehicle"),
        ("geojson", [0], "must rise from 0 to the horizon"),
        ("geojson", [0, 2, 1], "must rise from 0 to the horizon"),
        ("geojson", [0, 1e300], "must be"),
    ],
)
def test_steps_that_lead_nowhere_are_refused(to: str, steps: Any, expected: str) -> None:
    plan = plan_of(HARBOR)
    named = {t.name: steps for t in plan.trajectories} if steps else {}
    origin = None if to == "csv" else ORIGIN
    with pytest.raises(ScenarioError, match=expected):
        export_plan(plan, to, "out", ExportOptions(origin, steps=named))
