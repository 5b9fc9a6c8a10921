"""Trails of samples: who collides with what, when and where, or loses the range it keeps."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from radmpc import plan
from radmpc.io.native.decoding import decode_scenario
from radmpc.serving.work.control import Control
from radmpc.serving.work.trails import trails_of

NOISE = 0.02


def scene(**more):
    """Return a document of two vehicles side by side, without inertia."""
    return {
        "format": "radmpc/scenario/1", "name": "side by side", "dt": 1.0, "horizon": 6,
        "risk_bound": 0.4, "avoidance": "intervals",
        "defaults": {
            "radius": 0.3, "control_limit": 4, "disturbance_covariance": NOISE,
            "dynamics": {"A": [[1, 0], [0, 1]], "B": [[1, 0], [0, 1]], "position": [0, 1]},
        },
        "vehicles": [
            {"name": "a", "start": [0, 0], "goal": {"center": [6, 0], "half_width": 0.1}},
            {"name": "b", "start": [0, -2], "goal": {"center": [6, -2], "half_width": 0.1}},
        ],
        **more,
    }  # fmt: skip


def collisions(document):
    """Return trails that collide, each with the paths of vehicles by name."""
    control = Control(lambda kind, news: None, SimpleNamespace(value=0))
    found = plan(decode_scenario(document), "dlp", time_limit=20.0).require()
    view = trails_of(control, found, "p1", 500, 3)
    names = [vehicle["name"] for vehicle in document["vehicles"]]
    return [
        (trail["collision"], dict(zip(names, np.array(trail["paths"]), strict=True)))
        for trail in view["trails"]
        if trail["collision"]
    ]


def place(path, time):
    """Return where a path is at a time."""
    step = min(int(time), len(path) - 2)
    return path[step] + (time - step) * (path[step + 1] - path[step])


@pytest.mark.parametrize("avoidance", ["intervals", "steps"])
def test_who_loses_a_range_is_named_with_the_other_at_the_time_it_is_lost(avoidance):
    keep = [{"vehicles": ["b", "a"], "within": 2.4}]
    hits = collisions(scene(keep=keep, avoidance=avoidance))
    assert hits
    for hit, paths in hits:
        assert set(hit["names"]) == {"a", "b"}
        apart = np.linalg.norm(place(paths["a"], hit["time"]) - place(paths["b"], hit["time"]))
        assert apart >= 2.39
        assert apart <= 2.6 or avoidance == "steps"
        assert np.allclose(hit["at"], place(paths[hit["names"][0]], hit["time"]), atol=0.01)


@pytest.mark.parametrize("avoidance", ["intervals", "steps"])
def test_what_moves_is_hit_where_it_is_by_then(avoidance):
    outline = [[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]]
    ship = {"outline": outline, "start": [-2, 0.9, 2, 0]}
    obstacles = [{"name": "ship", "moving": ship}]
    hits = collisions(scene(obstacles=obstacles, avoidance=avoidance))
    assert hits
    for hit, paths in hits:
        assert hit["names"] == ["a", "ship"]
        aside = place(paths["a"], hit["time"]) - [-2 + 2 * hit["time"], 0.9]
        distance = np.linalg.norm(np.maximum(np.abs(aside) - [0.5, 0.2], 0.0))
        assert distance <= 0.43  # corners are square


def test_what_strays_is_hit_where_it_strayed_to():
    outline = [[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]]
    ship = {"outline": outline, "start": [-2, 3.5, 2, 0], "covariance": [0.01, 2.0, 0, 0]}
    hits = collisions(scene(obstacles=[{"name": "ship", "moving": ship}], risk_bound=0.45))
    times = {hit["time"] % 1.0 for hit, _ in hits if "ship" in hit["names"]}
    # From where it is expected nobody is near: the time would be that of the nearest end.
    assert len(times - {0.0}) >= 3
