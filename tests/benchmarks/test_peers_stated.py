"""The program that peers are given, and who judges their answers."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from peers.judge import judge
from peers.statement import NotModeledError, state
from radmpc.experiments.families import clutter, paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Workspace
from radmpc.planning import plan


def test_the_judge_finds_what_the_front_door_finds():
    scenario = paper(2, 0)
    result = plan(scenario, "certified", rng=0)
    controls = [t.controls for t in result.require().trajectories]
    verdict = judge(scenario, controls, "me")
    assert verdict.is_within
    assert verdict.cost == result.cost
    assert verdict.certified == result.certificate.certified
    above = judge(replace(scenario, risk_bound=1e-6), controls, "me")
    assert (above.is_within, above.problems) == (False, ())
    bad = [np.full_like(one, np.nan) for one in controls]
    assert judge(scenario, bad, "me").certified is None
    assert judge(scenario, controls[:1], "me").problems


def test_the_statement_spreads_the_bound_over_all_avoidances():
    statement = state(paper(3, 0))
    assert len(statement.dangers) == 3 * 3 + 3
    assert statement.share * len(statement.dangers) * 10 == pytest.approx(0.05, rel=1e-6)
    assert norm.sf(statement.sigmas) == pytest.approx(statement.share)


def test_the_statement_holds_walls_moving_things_and_pieces():
    outlines = [
        [[k, 9.0], [k + 1.0, 9.0], [k + 1.0, 10.0]] + [[k, 10.0]] * (k % 2) for k in range(11)
    ]
    corner = [[1, 16], [3, 16], [3, 16.5], [1.5, 16.5], [1.5, 18], [1, 18]]
    scenario = replace(
        paper(1, 0),
        obstacles=(Obstacle.moving("ferry", outlines), Obstacle.polygon("corner", corner)),
        workspace=Workspace(np.zeros(2), np.full(2, 20.0)),
    )
    statement = state(scenario)
    assert [d.normals.shape[1] for d in statement.dangers] == [4, 4, 4, 1, 1, 1, 1]
    reach = statement.reach()
    means = plan(paper(1, 0), "dlp").require().trajectories[0].means[:, :2]
    assert np.all(means >= reach[0][0] - 1e-6)
    assert np.all(means <= reach[1][0] + 1e-6)
    for danger in statement.dangers:
        missed = statement.needs(danger) - np.einsum("kfd,kd->kf", danger.normals, means)
        assert np.all(missed <= statement.big_m(danger, reach) + 1e-6)


def test_a_start_in_conflict_leaves_nothing_to_share():
    scenario = paper(1, 0)
    x, y = scenario.vehicles[0].start_position
    rock = Obstacle.box("rock", (x - 0.5, y - 0.5), (x + 0.5, y + 0.5))
    assert state(replace(scenario, obstacles=(rock,))).share < 0.0


def test_intervals_are_not_modeled():
    with pytest.raises(NotModeledError, match="intervals"):
        state(clutter(1, 2, 0))
