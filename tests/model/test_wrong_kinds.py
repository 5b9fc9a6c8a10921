"""What functions of the model say to what is of another kind, or without end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from radmpc import (
    Measurement,
    Obstacle,
    ScenarioError,
    Visit,
    double_integrator,
    double_integrator_noise,
    steps_visited,
    survey_visits,
    track_from_course,
    white_density,
)
from radmpc.experiments.families import circle

SCENE = circle(2)
BOAT = SCENE.vehicles[0]
TRACKED = Obstacle.tracked("ship", [[0, 0], [1, 0], [0, 1]], [0, 0, 1, 1])

CALLS: dict[str, tuple[Callable[[], object], str]] = {
    "an array for whether a system is a double integrator": (
        lambda: replace(BOAT.system, is_double_integrator=np.ones(2)),
        r"^is_double_integrator: must be true or false, got a ndarray",
    ),
    "a span of time for a number": (
        lambda: replace(BOAT, radius=np.timedelta64(1, "s")),
        r"^radius: must be a number, got datetime.timedelta",
    ),
    "a horizon without end": (
        lambda: replace(SCENE, horizon=10**18),
        r"^horizon: must be at most 1000000 steps, got 10",
    ),
    "a track laid out for no time": (
        lambda: TRACKED.laid_out(None, 3),
        r"^dt: must be a number, got None",
    ),
    "a track laid out for half a step": (
        lambda: TRACKED.laid_out(1.0, 1.5),
        r"^horizon: must be an integer, got 1.5",
    ),
    "holes that are none": (
        lambda: Obstacle.polygon("a", [[0, 0], [1, 0], [0, 1]], None),
        r"^holes: must be a list of outlines, got None",
    ),
    "a number for corners": (
        lambda: Obstacle.polygon("a", np.array(1.0)),
        r"^vertices: must have shape \(any, any\), got \(\)",
    ),
    "a number for an outline": (
        lambda: Obstacle.tracked("a", np.array(1.0), [0, 0, 1, 1]),
        r"^moving.outline: must have shape \(any, any\), got \(\)",
    ),
    "no corner of an area": (
        lambda: survey_visits(np.zeros((0, 2)), 1.0),
        r"^area: must have three corners or more",
    ),
    "an arrival without a path": (
        lambda: BOAT.goal.arrival(None, None),
        r"^positions: must have shape \(any, 2\), got \(\)",
    ),
    "an arrival of another plane": (
        lambda: BOAT.goal.arrival(np.zeros((3, 3)), None),
        r"^positions: must have shape \(any, 2\), got \(3, 3\)",
    ),
    "an arrival within text": (
        lambda: BOAT.goal.arrival(np.zeros((3, 2)), None, tol="1"),
        r"^tol: must be a number, got '1'",
    ),
    "speeds of another path": (
        lambda: BOAT.goal.arrival(np.zeros((3, 2)), np.zeros((2, 2))),
        r"^velocities: must have shape \(3, 2\), got \(2, 2\)",
    ),
    "a window of no horizon": (
        lambda: Visit.at([0, 0]).window(None),
        r"^horizon: must be an integer, got None",
    ),
    "nothing to visit": (
        lambda: steps_visited(None, np.zeros((3, 2)), None),
        r"^visits: must be a sequence of Visits, got None",
    ),
    "a visit to text": (
        lambda: steps_visited("x", np.zeros((3, 2)), None),
        r"^visits\[0\]: must be a Visit, got 'x'",
    ),
    "a visit of another plane": (
        lambda: steps_visited([Visit.at([0, 0])], np.zeros((3, 3)), None),
        r"^visits\[0\]: must have 3 coordinates like the position, got 2",
    ),
    "a measurement of no states": (
        lambda: Measurement.of([0], None, 1.0),
        r"^num_states: must be an integer, got None",
    ),
    "a measurement of states without end": (
        lambda: Measurement.of([0], 10**400, 1.0),
        r"^num_states: must be from 1 to 10000, got 1000",
    ),
    "a number for visits": (
        lambda: replace(BOAT, via=np.float64(1.0)),
        r"^via: must be a sequence of Visits, got 1.0",
    ),
    "a number for ranges": (lambda: replace(SCENE, keep=np.float64(1.0)), r"^keep: must .* 1.0"),
    "a number for what is shared": (
        lambda: replace(BOAT, shared=np.float64(1.0)),
        r"^shared: must .* got 1.0",
    ),
    "axes without end": (
        lambda: double_integrator(1.0, 10**400),
        r"^dimension: must be 2 or 3, got 10+\.\.\.0+$",
    ),
    "gusts without end": (
        lambda: double_integrator_noise(1e308, 2, 1.0),
        r"^dt: must lie between 1e-06 and 1e\+06 s, got 1e\+308",
    ),
    "a gust too strong": (lambda: white_density(1e308, 1.0), r"^std: must be at most 1000000000"),
    "a speed too high": (
        lambda: track_from_course([0, 0], 1e308, 0.0),
        r"^speed: must be at most 1000000000, got 1e\+308",
    ),
}


@pytest.mark.parametrize(("call", "expected"), CALLS.values(), ids=CALLS)
def test_what_is_of_another_kind_is_refused_in_one_line(
    call: Callable[[], object], expected: str
) -> None:
    with pytest.raises(ScenarioError, match=expected) as caught:
        call()
    assert str(caught.value).isprintable()


def test_a_course_that_is_hardly_uncertain_has_a_covariance() -> None:
    start, covariance = track_from_course([0, 0], 5.0, 90.0, course_deviation=1e-320)
    assert start == pytest.approx([0, 0, 5, 0])
    assert np.all(np.isfinite(covariance))
