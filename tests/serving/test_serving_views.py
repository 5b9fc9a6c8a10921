"""What the page draws, and what it may drag: handles move what they stand for."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import get_args

import numpy as np
import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.text.yaml_text import read_yaml
from radmpc.model.relations.couplings import Coupling, Reason
from radmpc.serving.documents.content import changed
from radmpc.serving.views.ellipses import ellipses_of
from radmpc.serving.views.handles import value_at
from radmpc.serving.views.numbers import Rounding
from radmpc.serving.views.plan import _coupling, plan_summary, plan_view
from radmpc.serving.views.scenario import scenario_view
from radmpc.serving.work.reasons import remarks_of

SHAPES = {
    "polygon": {"vertices": [[10, 10], [14, 10], [14, 14], [10, 14]],
                "holes": [[[11, 11], [12, 11], [12, 12]]]},
    "fence": {"line": [[10, 10], [14, 10], [14, 14]]},
    "box": {"min": [10, 10], "max": [14, 13]},
    "half-planes": {"normals": [[1, 0], [-1, 0], [0, 1], [0, -1]], "offsets": [14, -10, 14, -10]},
    "steps": {"moving": [[[10 + k, 10], [12 + k, 10], [11 + k, 12]] for k in range(7)]},
    "track": {"moving": {"outline": [[-1, -1], [1, -1], [0, 1]], "start": [10, 10, 0.5, 0],
                         "covariance": [0.1, 0.1, 0.01, 0.01]}},
    "report": {"moving": {"outline": [[-1, -1], [1, -1], [0, 1]], "position": [10, 10],
                          "speed": 0.5, "course": 90}},
}  # fmt: skip


def world(shape):
    return {
        "format": "radmpc/scenario/1", "name": "w", "dt": 1.0, "horizon": 6, "risk_bound": 0.05,
        "workspace": {"min": [0, 0], "max": [40, 40]},
        "obstacles": [{"name": "o", **shape}],
        "defaults": {"radius": 0.5, "control_limit": 1, "goal": {"center": [30, 30]}},
        "vehicles": [
            {"name": "a", "start": [1, 1, 0, 0], "goal": {"center": [5, 5], "half_width": 1},
             "via": [{"min": [2, 2], "max": [3, 3]}]},
            {"name": "b", "start": [9, 1], "goal": {"min": [5, 1], "max": [6, 2]},
             "survey": {"area": [[20, 20], [30, 20], [30, 30]], "spacing": 8}},
            {"name": "c", "start": [3, 9]},
        ],
    }  # fmt: skip


def with_corners(content, handle):
    """Return a document with corners in place of half-spaces, if the handle is of these."""
    if value_at(content, handle["x"][0]) is not None:
        return content
    _, *corners = scenario_view(decode_scenario(content), content)["obstacles"][0]["handles"]
    entry = {"name": "o", "vertices": [corner["at"] for corner in corners]}
    return changed(content, [{"path": ["obstacles", 0], "value": entry}])


def dragged(content, handle, move):
    """Return a document after a drag, as the page makes it."""
    content, changes = with_corners(content, handle), []
    for key, delta in zip("xyz", move, strict=False):
        for path in handle[key]:
            changes.append({"path": path, "value": value_at(content, path) + delta})
    return changed(content, changes)


def handles_of(view):
    found = [*view["workspaceHandles"]]
    for vehicle in view["vehicles"]:
        found += [vehicle["startHandle"]] if vehicle["startHandle"] else []
        for goal in (vehicle["goal"], *vehicle["via"]):
            found += goal["handles"]
    for obstacle in view["obstacles"]:
        found += obstacle["handles"]
    return found


@pytest.mark.parametrize("kind", SHAPES)
def test_a_handle_that_is_dragged_is_where_it_was_dragged_to(kind):
    content = world(SHAPES[kind])
    view = scenario_view(decode_scenario(content), content)
    handles, move = handles_of(view), np.array([0.25, -0.125])
    assert len(handles) >= 4 + 3 + 1 + 5 + 5 + 4
    # What is not the obstacle's is the same whatever the obstacle.
    first = 0 if kind == "box" else len(handles) - len(view["obstacles"][0]["handles"])
    for number, handle in list(enumerate(handles))[first:]:
        after = dragged(content, handle, move)
        again = handles_of(scenario_view(decode_scenario(after), after))[number]
        np.testing.assert_allclose(again["at"], np.add(handle["at"], move), atol=1e-3)


def test_what_is_computed_or_of_all_vehicles_cannot_be_dragged():
    content = world(SHAPES["half-planes"])
    view = scenario_view(decode_scenario(content), content)
    assert view["vehicles"][2]["goal"]["handles"] == []
    assert view["vehicles"][2]["startHandle"] is not None
    ends = view["vehicles"][1]["via"]
    assert ends[0]["path"] == ["vehicles", 1, "survey"]
    assert [len(end["handles"]) for end in ends] == [4] + [0] * (len(ends) - 1)


def test_what_moves_is_displaced_step_by_step():
    for kind in ("steps", "track", "report"):
        content = world(SHAPES[kind])
        (obstacle,) = scenario_view(decode_scenario(content), content)["obstacles"]
        corners = np.array(obstacle["rings"][0])
        moving = np.array(obstacle["moving"])
        assert moving.shape == (7, *corners.shape)
        speed = 1.0 if kind == "steps" else 0.5
        np.testing.assert_allclose(moving[6], np.broadcast_to([6 * speed, 0.0], corners.shape))
        assert (obstacle["uncertain"] is not None) == (kind == "track")


def test_outlines_of_other_corners_at_each_step_are_told_with_as_many():
    outlines = [[[10 + k, 10], [12 + k, 10], [11 + k, 12], [10 + k, 12]][: 3 + k % 2]
                for k in range(7)]  # fmt: skip
    content = world({"moving": outlines})
    (obstacle,) = scenario_view(decode_scenario(content), content)["obstacles"]
    ring, moving = np.array(obstacle["rings"][0]), np.array(obstacle["moving"])
    for k, outline in enumerate(outlines):
        there = {tuple(np.round(corner, 3)) for corner in ring + moving[k]}
        assert there == {tuple(np.round(corner, 3).tolist()) for corner in np.array(outline, float)}


def test_solids_have_triangles_of_their_corners():
    text = files("radmpc.data").joinpath("templates", "drones.yaml").read_text(encoding="utf-8")
    content, _ = read_yaml(text, "drones")
    view = scenario_view(decode_scenario(content), content)
    assert view["dimension"] == 3
    for obstacle in view["obstacles"]:
        assert obstacle["kind"] == "solid"
        used = {index for triangle in obstacle["triangles"] for index in triangle}
        assert used <= set(range(len(obstacle["corners"])))
        assert len(obstacle["triangles"]) >= 1
    handle = view["vehicles"][0]["startHandle"]
    assert handle["z"] == [["vehicles", 0, "start", 2]]


def test_ellipses_are_one_standard_deviation_along_their_axes():
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    (told,) = ellipses_of((turn @ np.diag([4.0, 0.25]) @ turn.T)[None])
    np.testing.assert_allclose(told["axes"], [2.0, 0.5])
    assert abs(abs(np.tan(told["angle"])) - 0.75) < 1e-3
    (solid,) = ellipses_of(np.diag([1.0, 9.0, 4.0])[None])
    rotation = np.reshape(solid["rotation"], (3, 3))
    np.testing.assert_allclose(solid["axes"], [3.0, 2.0, 1.0])
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-3)
    assert np.linalg.det(rotation) > 0.0


def test_places_are_as_exact_as_a_screen_shows_them():
    rounding = Rounding.of(np.zeros(2), np.array([5000.0, 10.0]))
    assert rounding.point([1234.56789, 0.004]) == [1234.6, 0.0]


@pytest.mark.parametrize("reason", get_args(Reason))
def test_every_reason_to_plan_two_together_is_told(reason):
    told = _coupling(Coupling("tug", "barge", reason, 0.5))
    assert told["text"].startswith("tug and barge ")


def test_whom_an_obstacle_concerns_and_who_keeps_in_range_is_told():
    content = world({"min": [10, 10], "max": [14, 13], "except": ["a", "b"]})
    content["obstacles"].append({"name": "shoal", "min": [20, 1], "max": [22, 3], "for": ["c"]})
    content["obstacles"].append({"name": "rock", "min": [24, 1], "max": [26, 3]})
    content["keep"] = [{"vehicles": ["a", "c"], "within": 12.5}]
    view = scenario_view(decode_scenario(content), content)
    assert [one["only"] for one in view["obstacles"]] == ["not for a, b", "for c", None]
    assert view["ranges"] == [{"vehicles": ["a", "c"], "within": 12.5}]


def test_the_page_does_not_speak_of_keys_of_the_terminal():
    stopped = radmpc.plan(paper(5, 0), stop=lambda: True).record
    assert "Ctrl-C" in stopped.explanation
    summary = plan_summary(stopped, "p1", 0)
    view = plan_view(stopped, summary, remarks=remarks_of(stopped))
    assert "it was stopped on request" in summary["explanation"]
    assert "Ctrl-C" not in json.dumps(view)
