from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import vehicle

from radmpc import Obstacle, Scenario, Workspace, certify, plan, simulate
from radmpc.model.relations.concerns import all_but, only_for
from radmpc.preflight import Passage, outlook_of

WALL = Obstacle.box("shoal", [2.5, -4.0], [6.5, 4.0])


def crossing(wall: Obstacle, avoidance: str = "steps") -> Scenario:
    """Return two on their way across a wall, far from each other."""
    fleet = [vehicle("deep", [0.0, 3.0], [9.0, 3.0]), vehicle("flat", [0.0, -3.0], [9.0, -3.0])]
    return Scenario("draught", 1.0, 6, 0.01, fleet, [wall], avoidance=avoidance)


def strays(planned) -> list[float]:
    """Return how far each leaves the line from start to goal."""
    return [float(np.abs(t.means[:, 1] - t.means[0, 1]).max()) for t in planned.trajectories]


@pytest.mark.parametrize("planner", ["dlp", "radmpc", "certified"])
@pytest.mark.parametrize(
    "wall", [only_for(WALL, ["deep"]), all_but(WALL, ["flat"])], ids=["for", "except"]
)
def test_an_obstacle_is_passed_by_those_whom_it_concerns(planner: str, wall: Obstacle) -> None:
    found = plan(crossing(wall), planner)
    planned = found.require()
    deep, flat = strays(planned)
    assert deep > 0.9
    assert flat < 0.6
    certificate = certify(planned)
    assert certificate.problems == ()
    assert {row.vehicle for row in certificate.ledger if row.cause == "obstacle"} <= {"deep"}
    if found.certified_lower_bound is not None:
        assert found.cost is not None
        assert found.certified_lower_bound <= found.cost


def test_the_referee_and_simulation_let_others_through() -> None:
    planned = plan(crossing(all_but(WALL, ["deep", "flat"])), "dlp").require()
    assert certify(planned).certified < 1e-9
    assert simulate(planned, 2_000, rng=0).collisions == 0
    for wall, hits in ((WALL, 2), (only_for(WALL, ["flat"]), 1)):
        met = replace(planned, scenario=crossing(wall, "intervals"))
        rows = certify(met).ledger
        assert len({row.vehicle for row in rows if row.risk > 0.5}) == hits
        assert simulate(met, 2_000, rng=0).obstacle_rate == 1.0


def test_a_check_before_planning_looks_at_what_concerns_a_vehicle() -> None:
    wide = replace(WALL, concerns=None)
    for wall, met in ((wide, True), (only_for(WALL, ["deep"]), False)):
        blocked = replace(
            crossing(wall, "intervals"), workspace=Workspace([-1.0, -3.9], [10.0, 3.9])
        )
        assert (outlook_of(blocked).vehicles[1].narrowest is not Passage.WIDE) is met
    start = only_for(Obstacle.box("quay", [-1.0, -4.0], [1.0, -2.0]), ["deep"])
    assert outlook_of(crossing(start)).vehicles[1].start_risk == 0.0
    assert outlook_of(crossing(replace(start, concerns=None))).vehicles[1].start_risk > 0.5
