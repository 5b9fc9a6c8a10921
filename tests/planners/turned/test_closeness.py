"""What being near another vehicle costs on a track, move by move, against dense samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.turned.narrow import closeness as module
from radmpc.planners.certified.turned.narrow.closeness import closeness, passing_by
from radmpc.planners.certified.turned.narrow.track import Track
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.compiled_code import is_compiled

CLEARANCE = 2.5


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(6))
def test_every_move_costs_what_it_comes_too_near(avoidance: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    scenario = replace(circle(4), avoidance=avoidance)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    count, levels = 24, 3
    turns = np.cumsum(rng.normal(0.0, 0.3, count))
    places = np.cumsum(0.5 * np.column_stack([np.cos(turns), np.sin(turns)]), axis=0)
    nothing = np.zeros((levels, levels, count))
    each = Track(0, places, nothing.astype(int), nothing, 0, np.zeros(levels), 7.0)
    path = places[rng.integers(count)] + np.cumsum(rng.normal(0.0, 0.6, (13, 2)), axis=0)
    path[5] = path[4]
    steps, near, lack = closeness(hazards, each, 2, path, CLEARANCE)
    found = np.zeros((len(path) - 1, count, each.num_displacements))
    found[steps, near] = lack
    spread = np.sqrt((hazards.variances[0].max() + hazards.variances[2].max()) / 2)
    touching = hazards.radii[0] + hazards.radii[2]
    since = np.linspace(0.0, 1.0, 401)[:, None] if avoidance == "intervals" else np.ones((1, 1))
    for k in range(len(path) - 1):
        for place in range(count):
            for length in range(each.num_displacements):
                end = places[min(place + length, count - 1)]
                mine = places[place] * (1.0 - since) + end * since
                other = path[k] * (1.0 - since) + path[k + 1] * since
                least = np.linalg.norm(mine - other, axis=1).min()
                wanted = 7.0 * max(touching + CLEARANCE * spread - least, 0.0)
                told = found[k, place, length]
                if least < touching + spread - 1e-3:
                    assert np.isinf(told)
                elif least > touching + spread + 1e-3:
                    assert told == pytest.approx(wanted, abs=0.02)


@pytest.mark.skipif(not is_compiled(), reason="nothing to compare with")
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(10))
def test_compiled_code_tells_the_same_costs(
    avoidance: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(seed)
    scenario = replace(circle(4), avoidance=avoidance)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    count, levels = 150, 5
    # With corners, at which places are nearer to each other.
    corners = np.cumsum(rng.uniform(-4.0, 4.0, (6, 2)), axis=0)
    at = np.linspace(0.0, 5.0, count)
    places = np.stack([np.interp(at, np.arange(6), axis) for axis in corners.T], axis=1)
    nothing = np.zeros((levels, levels, count))
    each = Track(0, places, nothing.astype(int), nothing, 0, np.zeros(levels), 7.0)
    path = places[rng.integers(count)] + np.cumsum(rng.normal(0.0, 0.6, (40, 2)), axis=0)
    told = []
    for is_there in (True, False):
        monkeypatch.setattr(module, "is_compiled", lambda is_there=is_there: is_there)
        steps, near, lack = closeness(hazards, each, 2, path, CLEARANCE)
        costs = np.zeros((len(path) - 1, count, each.num_displacements))
        costs[steps, near] = lack
        told.append(costs)
    assert told[0].any()
    np.testing.assert_allclose(told[0], told[1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_who_is_not_told_to_pass_by_is_near_no_move(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scenario = circle(4)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    count, levels = 24, 3
    places = np.cumsum(rng.normal(0.0, 0.5, (count, 2)), axis=0)
    places[1:] = places[0] + np.linspace(0.3, 7.0, count - 1)[:, None] * [0.8, 0.6]
    nothing = np.zeros((levels, levels, count))
    each = Track(0, places, nothing.astype(int), nothing, 0, np.zeros(levels), 7.0)
    starts = places.mean(axis=0) + rng.uniform(-15.0, 15.0, (60, 1, 2))
    paths = starts + np.cumsum(rng.normal(0.0, 0.4, (60, 13, 2)), axis=1)
    passes = passing_by(hazards, each, paths, CLEARANCE)
    is_near = [closeness(hazards, each, 2, path, CLEARANCE)[0].size > 0 for path in paths]
    assert passes[is_near].all()
    assert any(is_near)
    # And most of those that are far away need no closer look.
    assert not passes.all()
