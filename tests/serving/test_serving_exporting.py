"""Exports that the page offers to download, and what it says of them."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from types import SimpleNamespace

import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.serving.desk.exporting import exported
from radmpc.serving.failures import CallError


@pytest.fixture(scope="module")
def plan():
    """A plan of two vehicles with a place on earth."""
    scenario = replace(paper(2, seed=1), source={"origin": {"latitude": 54.1, "longitude": 12.1}})
    return radmpc.plan(scenario, rng=0).require()


def export(plan, kind):
    """Return what the page is answered."""
    desk = SimpleNamespace(plan=lambda number: SimpleNamespace(plan=plan))
    return asyncio.run(exported(desk, {"plan": "p1", "format": kind}))


def test_an_export_that_needs_a_place_on_earth_says_how_to_state_one(plan):
    nowhere = replace(plan, scenario=replace(plan.scenario, source={}))
    with pytest.raises(CallError) as caught:
        export(nowhere, "kml")
    assert caught.value.kind == "refused"
    assert str(caught.value).startswith("kml needs the plan's place on earth: state it in")
    assert "radmpc export --origin" in str(caught.value)


def test_an_export_tells_what_its_format_loses(plan):
    assert export(plan, "csv")["warnings"] == []
    (timing,) = export(plan, "waypoints")["warnings"]
    assert timing.startswith("waypoints carry no time")


def test_an_export_of_a_plan_that_exceeds_its_bound_says_so(plan):
    bound = plan.risk.certified / 2
    over = replace(plan, scenario=replace(plan.scenario, risk_bound=bound))
    (risk,) = export(over, "csv")["warnings"]
    assert risk == f"the plan is not certified within its risk bound {bound:g}"
