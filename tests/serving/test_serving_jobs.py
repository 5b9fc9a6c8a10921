"""What workers do, done here: what is told, judged, drawn and advised."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.model.plan import Status
from radmpc.planning import plan
from radmpc.referee import simulate
from radmpc.serving.documents.content import changed
from radmpc.serving.views.plan import mean_path, plan_summary, plan_view
from radmpc.serving.work.asking import Asked
from radmpc.serving.work.charts import read_chart, read_obstacles
from radmpc.serving.work.concerns import concerns_of_content
from radmpc.serving.work.control import Control, stop_the_clock
from radmpc.serving.work.cures import why_not
from radmpc.serving.work.flying import fly_plan
from radmpc.serving.work.judging import judged
from radmpc.serving.work.plan_content import plan_content
from radmpc.serving.work.trails import trails_of

NOISY = [0.01, 0.01, 0.001, 0.001]


def two(horizon=8, *, avoidance="intervals"):
    """Return a document in which two vehicles pass each other beside a wall."""
    return {
        "format": "radmpc/scenario/1", "name": "two", "dt": 1.0, "horizon": horizon,
        "risk_bound": 0.2, "avoidance": avoidance,
        "workspace": {"min": [0, 0], "max": [12, 8]},
        "obstacles": [{"name": "wall", "min": [5, 0], "max": [6, 2.5]}],
        "defaults": {"radius": 0.4, "control_limit": 2, "speed_limit": 4,
                     "initial_covariance": NOISY, "disturbance_covariance": NOISY},
        "vehicles": [
            {"name": "a", "start": [1, 4], "goal": {"center": [11, 4], "half_width": 0.4}},
            {"name": "b", "start": [11, 5], "goal": {"center": [1, 4.5], "half_width": 0.4}},
        ],
    }  # fmt: skip


class Told(Control):
    """A control that keeps what it is told."""

    def __init__(self):
        self.news = []
        super().__init__(
            lambda kind, news: self.news.append((kind, news)), SimpleNamespace(value=0)
        )

    def of(self, kind):
        return [news for one, news in self.news if one == kind]


@cache
def planned():
    control = Told()
    asked = Asked({**two(), "risk_bound": 0.3}, "certified", 20.0, gap=0.2, risk_bound=0.2)
    ended = plan_content(control, asked)
    return control, ended


@pytest.mark.slow
def test_a_search_tells_of_better_plans_until_it_ends():
    control, ended = planned()
    better = control.of("improved")
    assert better
    costs = [one.cost for one in better]
    assert costs == sorted(costs, reverse=True)
    assert all(one.risk.certified <= 0.2 for one in better)
    assert ended.plan.cost <= costs[-1]
    # The same cost, summed in another order, may differ in the last bit.
    least = min(cost for cost, _ in control.of("found"))
    assert least >= ended.plan.cost * (1.0 - 1e-15)
    assert ended.remarks == ()


def test_another_risk_bound_is_planned_than_the_documents():
    assert planned()[1].plan.scenario.risk_bound == 0.2


def test_a_pause_is_no_time_spent(monkeypatch):
    held = SimpleNamespace(value=0.0)
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    stop_the_clock(held)
    from time import monotonic  # noqa: PLC0415 - the clock as it is now

    begun = monotonic()
    now[0] += 7.0
    held.value = 5.0
    assert monotonic() - begun == 2.0


def test_a_plan_is_drawn_along_its_curves_with_where_its_risk_goes():
    _, ended = planned()
    view = plan_view(ended.plan, plan_summary(ended.plan, "p1", 3))
    per_step, horizon = view["perStep"], 8
    assert per_step > 1
    for vehicle, part, track in zip(
        ended.plan.scenario.vehicles, ended.plan.trajectories, view["tracks"], strict=True
    ):
        assert len(track["path"]) == horizon * per_step + 1
        np.testing.assert_allclose(track["path"][::per_step], part.means[:, :2], atol=1e-3)
        assert len(track["ellipses"]) == len(track["speed"]) == horizon + 1
        # Half a step under the control that is held over it.
        x, v, u = part.means[2, :2], part.means[2, 2:], part.controls[2]
        np.testing.assert_allclose(
            mean_path(vehicle, part, 2)[5], x + 0.5 * v + 0.125 * u, atol=1e-9
        )
    risks = [line["risk"] for line in view["ledger"]]
    assert risks == sorted(risks, reverse=True)
    assert sum(risks) == pytest.approx(ended.plan.risk.certified, rel=1e-2)
    assert view["left"] == pytest.approx(0.2 - ended.plan.risk.certified)
    assert view["summary"]["holds"]
    assert view["summary"]["revision"] == 3
    assert any("at most" in sentence for sentence in view["report"])


@pytest.mark.parametrize("avoidance", ["intervals", "steps"])
def test_trails_collide_as_often_as_the_simulation_and_where_somebody_is(avoidance):
    document = two(avoidance=avoidance)
    start = decode_scenario(document)
    risky = plan(replace(start, risk_bound=0.4), "dlp", time_limit=20.0).require()
    view = trails_of(Told(), risky, "p1", 3000, 4)
    assert view["flights"] == 3000
    low, high = view["interval"]
    assert low <= view["collisions"] / 3000 <= high
    rate = simulate(risky, 20_000, rng=1).rate
    assert low - 0.02 <= rate <= high + 0.02
    hits = [trail for trail in view["trails"] if trail["collision"]]
    assert hits
    assert hits == view["trails"][: len(hits)]
    for trail in hits:
        hit = trail["collision"]
        assert set(hit["names"]) <= {"a", "b", "wall"}
        assert 0.0 <= hit["time"] <= 8.0
        paths = dict(zip("ab", np.array(trail["paths"]), strict=True))
        step = int(hit["time"])
        way = paths[hit["names"][0]][step : step + 2]
        room = 0.5 + np.abs(np.diff(way, axis=0)).max(initial=0.0)
        assert (way.min(axis=0) - room <= hit["at"]).all()
        assert (way.max(axis=0) + room >= hit["at"]).all()
    again = trails_of(Told(), risky, "p1", 3000, 4)
    assert again == view


def test_a_plan_from_a_file_is_believed_only_as_far_as_the_referee_does():
    plan_ = planned()[1].plan
    boastful = replace(plan_, risk=replace(plan_.risk, certified=1e-9, ledger=()))
    assert judged(Told(), boastful).risk.certified == pytest.approx(plan_.risk.certified)
    first = plan_.trajectories[0]
    forged = replace(first, means=first.means + 0.5)
    with pytest.raises(ScenarioError):
        judged(Told(), replace(plan_, trajectories=(forged, plan_.trajectories[1])))


def test_a_concern_about_time_has_a_longer_horizon_as_its_cure():
    remarks = concerns_of_content(Told(), two(horizon=4))
    fatal = [remark for remark in remarks if remark["severity"] == "fatal"]
    assert fatal
    (change,) = fatal[0]["cures"][0]["changes"]
    assert change["path"] == ["horizon"]
    assert fatal[0]["at"] in ([11.0, 4.0], [1.0, 4.5])
    cured = changed(two(horizon=4), fatal[0]["cures"][0]["changes"])
    left = concerns_of_content(Told(), cured)
    assert not [remark for remark in left if remark["severity"] == "fatal"]


@pytest.mark.nightly
@pytest.mark.nightly
def test_why_not_is_answered_at_the_place_with_cures_that_lead_to_plans():
    document = two(horizon=4)
    remarks = why_not(Told(), document)
    assert remarks[0]["severity"] == "fatal"
    assert set(remarks[0]["vehicles"]) <= {"a", "b"}
    assert remarks[0]["at"] is not None
    cures = [cure for remark in remarks for cure in remark["cures"]]
    assert cures
    cured = decode_scenario(changed(document, cures[0]["changes"]))
    found = []
    result = plan(cured, time_limit=20.0, improved=found.append, stop=lambda: bool(found))
    assert found or result.is_certified


def test_a_search_without_a_plan_says_why_at_the_place():
    ended = plan_content(Told(), Asked(two(horizon=4), "certified", 1.0))
    assert ended.plan.status is Status.INFEASIBLE
    assert ended.remarks[0]["path"][0] in {"vehicles", "horizon"}
    view = plan_view(ended.plan, plan_summary(ended.plan, "p", 0), None, ended.remarks)
    assert view["tracks"] == []
    assert not view["summary"]["holds"]
    assert view["remarks"] == list(ended.remarks)


def test_a_plan_above_its_bound_says_what_takes_the_risk():
    ended = plan_content(Told(), Asked({**two(), "risk_bound": 1e-4}, "dlp", 10.0))
    worst = ended.remarks[0]
    assert "certified" in worst["text"]
    assert worst["severity"] == "warning"
    assert len(worst["at"]) == 2


def test_a_flight_tells_every_tick_and_stops_when_asked(tmp_path):
    control = Told()
    log = str(tmp_path / "flight.jsonl")
    told = fly_plan(control, planned()[1].plan, 3, 0.0, {"replan": "none", "log": log})
    assert told.startswith("flown to its end")
    ticks = control.of("tick")
    assert [tick["step"] for tick in ticks] == list(range(9))
    assert all(len(tick["states"]) == 2 for tick in ticks)
    assert ticks[0]["left"] <= 0.2 * (1.0 + 1e-6) or ticks[0]["alarm"]
    lines = (tmp_path / "flight.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 10
    stopped = Told()
    stopped.is_stopped = lambda: len(stopped.of("tick")) > 2
    assert fly_plan(stopped, planned()[1].plan, 3, 0.0, {"replan": "none"}) == "stopped"
    assert len(stopped.of("tick")) == 3


def test_a_chart_becomes_a_document(tmp_path):
    place = tmp_path / "c.geojson"
    point = '{"type": "Feature", "properties": {"name": "%s a"}, "geometry": {"type": "Point", "coordinates": [%s]}}'  # noqa: E501 - JSON
    features = ", ".join([point % ("start", "10, 54"), point % ("goal", "10.001, 54.001")])
    text = f'{{"type": "FeatureCollection", "features": [{features}]}}'
    place.write_text(text, encoding="utf-8")
    content = read_chart(Told(), str(place), "c.geojson")
    assert [vehicle["name"] for vehicle in content["vehicles"]] == ["a"]
    assert encode_scenario(decode_scenario(content)) == content


GROUND = """{"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"name": "rock"}, "geometry": {"type": "Polygon",
     "coordinates": [[[10, 54], [10.0002, 54], [10.0002, 54.0001], [10, 54.0001], [10, 54]]]}},
    {"type": "Feature", "properties": {"name": "wall", "role": "obstacle"},
     "geometry": {"type": "LineString", "coordinates": [[10.0004, 54], [10.0004, 54.0003]]}}]}"""


@pytest.fixture
def ground(tmp_path):
    """A chart on which nobody starts: a rock of 13 by 11 m, and a wall 13 m east of it."""
    place = tmp_path / "coast.geojson"
    place.write_text(GROUND, encoding="utf-8")
    return str(place)


def corners_of(entries):
    """Return the corners of a rock and a wall."""
    rock, wall = entries
    return np.vstack([rock["vertices"], wall["line"]])


def test_a_chart_on_which_nobody_starts_becomes_a_world_in_meters(ground):
    content = read_chart(Told(), ground, "coast.geojson")
    assert (content["name"], content["vehicles"]) == ("coast", [])
    assert content["source"]["file"] == "coast.geojson"
    assert [entry["name"] for entry in content["obstacles"]] == ["rock", "wall"]
    corners = corners_of(content["obstacles"])
    size = corners.max(axis=0) - corners.min(axis=0)
    np.testing.assert_allclose(size, [26.2, 33.4], atol=0.2)
    assert np.abs(corners).max() < 30
    workspace = content["workspace"]
    assert (corners.min(axis=0) >= np.array(workspace["min"]) + 5).all()
    assert (corners.max(axis=0) <= np.array(workspace["max"]) - 5).all()
    # Somebody drawn makes it a scenario.
    somebody = {"name": "a", "start": workspace["min"], "goal": {"center": workspace["max"]}}
    assert decode_scenario({**content, "vehicles": [somebody]}).obstacles[1].name == "wall"


def test_a_chart_is_added_where_it_is_on_earth_or_in_the_middle_of_the_workspace(ground):
    content = read_chart(Told(), ground, "coast.geojson")
    again = read_obstacles(Told(), ground, "coast.geojson", content)
    np.testing.assert_allclose(corners_of(again), corners_of(content["obstacles"]), atol=1e-6)
    content["source"]["origin"]["longitude"] -= 0.01  # a neighbor's
    beside = corners_of(read_obstacles(Told(), ground, "coast.geojson", content))
    np.testing.assert_allclose(beside - corners_of(again), [[655.6, 0.0]] * len(beside), atol=0.5)
    document = two()
    corners = corners_of(read_obstacles(Told(), ground, "coast.geojson", document))
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    np.testing.assert_allclose(middle, [6, 4], atol=0.6)
