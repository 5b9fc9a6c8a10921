from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from radmpc import Goal, Scenario, ScenarioError, Vehicle, Visit, Workspace, double_integrator
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.visits import steps_of_visits, steps_visited

HORIZON = 9


def scenario(*via: Visit, workspace: Workspace | None = None) -> Scenario:
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=[0.0, 0.0],
        goal=Goal.at([10.0, 0.0], 0.5),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=0.0,
        disturbance_covariance=0.0,
        via=via,
    )
    return Scenario("visits", 1.0, HORIZON, 0.01, [vehicle], workspace=workspace)


def test_a_visit_keeps_its_box_window_and_speed() -> None:
    visit = Visit.at([1.0, 2.0], 0.5, between=[2, 5], speed=1.5)
    assert visit.lower.tolist() == [0.5, 1.5]
    assert visit.upper.tolist() == [1.5, 2.5]
    assert visit.between == (2, 5)
    assert visit.center.tolist() == [1.0, 2.0]
    assert visit.speed is not None
    assert visit.speed.tolist() == [1.5, 1.5]
    assert Visit.at([0.0, 0.0]).window(HORIZON) == (1, HORIZON - 1)


def test_vehicles_keep_their_visits_through_pickles_and_files() -> None:
    given = scenario(Visit.at([1.0, 2.0], 0.5), Visit([3.0, 3.3], [4.1, 5.0], (2, 6), 0.7))
    for copy in (pickle.loads(pickle.dumps(given)), from_dict(to_dict(given))):
        for one, two in zip(given.vehicles[0].via, copy.vehicles[0].via, strict=True):
            assert np.array_equal(one.lower, two.lower)
            assert np.array_equal(one.upper, two.upper)
            assert one.between == two.between
            assert one.speed is two.speed or np.array_equal(one.speed, two.speed)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Visit.at([0.0, 0.0], -1.0), "half_width: must be >= 0 m, got [-1.0, -1.0]"),
        (lambda: Visit([1.0, 0.0], [0.0, 0.0]), "min must not exceed max, got [1.0, 0.0]"),
        (lambda: Visit.at([0.0, 0.0], speed=-1.0), "speed: must be >= 0 m/s, got [-1.0, -1.0]"),
        (lambda: Visit.at([0.0, 0.0], between=[3, 2]), "between: must be two steps, 1 <= first"),
        (lambda: Visit.at([0.0, 0.0], between=[0, 2]), "between: must be two steps, 1 <= first"),
        (lambda: Visit.at([0.0, 0.0], between=[1, 2, 3]), "between: must be two steps, the first"),
        (lambda: Visit.at([0.0, 0.0], between=[1, 2.5]), "between[1]: must be an integer, got 2.5"),
        (lambda: Visit.at([0.0, 0.0], between=7), "between: must be two steps, the first"),
        (lambda: scenario("box"), "via[0]: must be a Visit, got 'box'"),
        (
            lambda: scenario(Visit.at([0.0] * 3)),
            "via[0]: must have 2 coordinates like the position",
        ),
        (
            lambda: scenario(Visit.at([0.0, 0.0], between=[2, 10])),
            "vehicles[0].via[0].between: must end at the horizon of 9 steps at the latest, got 10",
        ),
        (
            lambda: scenario(
                Visit.at([0.0, 0.0], between=[4, 5]), Visit.at([1.0, 0.0], between=[1, 4])
            ),
            "vehicles[0].via[0]: leaves no step: visits must take place in order, one step apart",
        ),
        (
            lambda: scenario(
                Visit.at([-5.0, 0.0]), workspace=Workspace([-1.0, -1.0], [12.0, 12.0])
            ),
            "vehicles[0].via[0]: must touch the workspace [-1.0, -1.0] to [12.0, 12.0]",
        ),
    ],
)
def test_what_is_no_visit_is_refused_in_one_line(make, told: str) -> None:
    with pytest.raises(ScenarioError) as refusal:
        make()
    assert told in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_speed_at_a_visit_needs_velocities() -> None:
    given = scenario().vehicles[0]
    blind = replace(given.system, velocity=None)
    with pytest.raises(ScenarioError, match=r"via\[0\].speed: a speed needs dynamics"):
        replace(
            given,
            system=blind,
            goal=Goal.at([10.0, 0.0], 0.5, None),
            via=(Visit.at([0.0, 0.0], speed=1.0),),
        )


def test_errors_in_files_name_the_visit() -> None:
    content = to_dict(scenario(Visit.at([1.0, 2.0], 0.5)))
    for change, told in (
        ({"half_width": -0.5}, "vehicles[0].via[0].half_width: must be >= 0 m"),
        ({"between": [3]}, "vehicles[0].via[0].between"),
        ({"between": [5, 3]}, "vehicles[0].via[0].between: must be two steps, 1 <= first <= last"),
        ({"min": [0.0, 0.0]}, "vehicles[0].via[0]: needs either center"),
        ({"windows": [1, 2]}, "vehicles[0].via[0].windows: unknown key"),
    ):
        (vehicle,) = content["vehicles"]
        (visit,) = vehicle["via"]
        spoiled = {**content, "vehicles": [{**vehicle, "via": [{**visit, **change}]}]}
        with pytest.raises(ScenarioError) as refusal:
            from_dict(spoiled)
        assert told in str(refusal.value)


def test_windows_shrink_to_what_order_leaves() -> None:
    free, late = Visit.at([0.0, 0.0]), Visit.at([0.0, 0.0], between=(4, 9))
    assert steps_of_visits((free, free, free), 9) == ((1, 6), (2, 7), (3, 8))
    assert steps_of_visits((free, late, free), 9) == ((1, 6), (4, 7), (5, 8))
    assert steps_of_visits((), 9) == ()


def test_visits_are_found_on_a_path_at_their_earliest_steps() -> None:
    path = np.stack([np.arange(10.0), np.zeros(10)], axis=1)
    speeds = np.tile([1.0, 0.0], (10, 1))
    box = Visit.at([4.0, 0.0], 1.0)
    assert steps_visited((box,), path, speeds) == (3,)
    assert steps_visited((box, box, box), path, speeds) == (3, 4, 5)
    # The fourth would have to be at step 6, which is beside.
    assert steps_visited((box,) * 4, path, speeds) == (3, 4, 5)
    assert steps_visited((replace(box, speed=np.array([0.5, 0.5])),), path, speeds) == ()
    assert steps_visited((replace(box, between=(5, 9)),), path, None) == (5,)
