"""In isotropic noise at steps the best half-space is known without a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.arrays import field_names
from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.relative import are_isotropic
from radmpc.solvers.solution import Limits


def turned(
    scenario: Scenario, shift: float, *, is_known: bool, is_refined: bool = True
) -> tuple[HalfSpaces, SuccessiveLp]:
    """Turn half-spaces to where all are expected, a little aside of what they do alone."""
    hazards = Hazards.of(scenario, condensed_models(scenario))
    assert hazards.is_isotropic
    successive = SuccessiveLp(replace(hazards, is_isotropic=is_known), Limits())
    assert successive.begin_alone()
    rng = np.random.default_rng(3)
    successive.ahead.means += shift * rng.normal(size=successive.ahead.means.shape)
    everyone, near = tuple(range(hazards.count)), Near(6.5, 1.0, is_refined=is_refined)
    paths, ahead = successive.paths, successive.ahead
    return half_spaces(successive.hazards, paths, everyone, near, ahead), successive


def crossed_by_a_track(scenario: Scenario) -> Scenario:
    """Let something cross the middle whose place is known within some centimeters."""
    outline = [[-0.5, -1.0], [0.5, -1.0], [0.5, 1.0], [-0.5, 1.0]]
    vehicle = scenario.vehicles[0]
    start = [*(0.5 * (vehicle.start_position + vehicle.goal.center)), 0.0, 0.1]
    crossing = Obstacle.tracked("crossing", outline, start, [0.01, 0.01, 0.0, 0.0])
    return replace(scenario, obstacles=(*scenario.obstacles, crossing))


def clearances_ahead(spaces: HalfSpaces, successive: SuccessiveLp) -> np.ndarray:
    """Return the standard deviations that half-spaces leave where all are expected, (w,) array."""
    steps, means = spaces.windows + 1, successive.ahead.means
    others = np.where((spaces.second >= 0)[:, None], means[spaces.second, steps], 0.0)
    heights = np.einsum("wd,wd->w", spaces.normals, means[spaces.first, steps] - others)
    return np.asarray((heights - spaces.offsets[:, 1]) / spaces.deviations[:, 1])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("shift", [0.0, 0.05])
def test_half_spaces_are_no_worse_than_those_that_a_search_comes_to(
    seed: int, shift: float
) -> None:
    scenario = paper(4, seed)
    (known, successive), (sought, _) = (
        turned(scenario, shift, is_known=is_known) for is_known in (True, False)
    )
    assert np.array_equal(known.keys, sought.keys)
    assert known.count > 20
    # Nearer than that paths may be through each other, and half-spaces are turned to the latest.
    apart = np.minimum(known.clearances, sought.clearances).min(axis=1) > 1.0
    assert np.count_nonzero(apart) > 10
    left = clearances_ahead(known, successive) - clearances_ahead(sought, successive)
    assert np.all(left[apart] >= -1e-9)
    # A search ends within a thousandth of a turn, mostly.
    cosines = np.einsum("wd,wd->w", known.normals, sought.normals)[apart]
    assert np.median(cosines) > 1.0 - 1e-5


@pytest.mark.parametrize(
    "scenario", [paper(4, 1), crossed_by_a_track(paper(4, 2))], ids=["known", "tracked"]
)
def test_half_spaces_that_are_not_refined_are_those_of_any_noise(scenario: Scenario) -> None:
    known, general = (
        turned(scenario, 0.0, is_known=is_known, is_refined=False)[0] for is_known in (True, False)
    )
    assert known.count > 20
    assert {-1} < set(known.second.tolist())
    for name in field_names(HalfSpaces):
        ours, theirs = getattr(known, name), getattr(general, name)
        assert ours.dtype == theirs.dtype
        assert np.allclose(ours, theirs, rtol=1e-9, atol=1e-9, equal_nan=True)


def test_noise_is_isotropic_only_if_it_is_the_same_in_all_directions() -> None:
    same = np.array([0.2, 1e-30, 3.0])[:, None, None] * np.eye(2)
    assert are_isotropic(same)
    assert are_isotropic(None)
    for other in ([[1.0, 0.0], [0.0, 1.1]], [[1.0, 0.1], [0.1, 1.0]]):
        assert not are_isotropic(np.concatenate([same, np.array([other])]))
