from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.linalg import expm

from radmpc import ScenarioError, double_integrator
from radmpc.model.discretization import (
    double_integrator_noise,
    step_covariance,
    white_density,
)
from radmpc.model.dynamics import covariances


def integrated(F: np.ndarray, Q: np.ndarray, dt: float) -> np.ndarray:
    """The same by quadrature."""
    found, _ = quad_vec(lambda s: expm(F * s) @ Q @ expm(F.T * s), 0.0, dt)
    return found


@pytest.mark.parametrize("seed", range(5))
def test_the_covariance_of_a_step_is_the_integral_that_defines_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 2 + seed % 3
    F = rng.normal(size=(n, n))
    root = rng.normal(size=(n, n))
    W = step_covariance(F, root @ root.T, 0.7)
    assert pytest.approx(integrated(F, root @ root.T, 0.7), rel=1e-9, abs=1e-12) == W
    assert np.array_equal(W, W.T)


@pytest.mark.parametrize("d", [2, 3])
def test_the_closed_form_is_that_of_the_double_integrator(d: int) -> None:
    F = np.zeros((2 * d, 2 * d))
    F[:d, d:] = np.eye(d)
    pushed, carried = np.arange(1.0, d + 1), 0.3
    W = double_integrator_noise(2.0, d, pushed, carried)
    density = np.append(np.full(d, carried), pushed)
    assert pytest.approx(step_covariance(F, density, 2.0), rel=1e-12) == W
    assert pytest.approx(integrated(F, np.diag(density), 2.0), rel=1e-9) == W


def test_what_happens_in_a_second_does_not_depend_on_the_step() -> None:
    ends = []
    for dt in (1.0, 0.5, 0.1):
        W = double_integrator_noise(dt, 2, 0.04, 0.01)
        system = double_integrator(dt, 2)
        ends.append(covariances(system, np.zeros((4, 4)), W, None, round(10.0 / dt))[-1])
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)
    assert ends[2] == pytest.approx(ends[0], rel=1e-9)


def test_a_gust_is_as_white_as_it_is_short() -> None:
    std, time_constant, seconds = 0.2, 0.5, 60.0
    # The acceleration as a state of its own: exact.
    F = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / time_constant]])
    Q = np.diag([0.0, 0.0, 2.0 * std**2 / time_constant])
    start = np.diag([0.0, 0.0, std**2])
    carried = expm(F * seconds)
    exact = carried @ start @ carried.T + step_covariance(F, Q, seconds)
    density = white_density(std, time_constant)
    white = double_integrator_noise(seconds, 2, density)
    assert density == pytest.approx(0.04)
    assert white[2, 2] == pytest.approx(exact[1, 1], rel=0.02)
    assert white[0, 0] == pytest.approx(exact[0, 0], rel=0.02)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: white_density(-1.0, 1.0), "std: must be >= 0"),
        (lambda: white_density(1.0, float("inf")), "time_constant: must be >= 0 s"),
        (lambda: step_covariance(np.eye(2), np.eye(3), 1.0), "density"),
        (lambda: step_covariance(np.ones((2, 3)), np.eye(2), 1.0), "drift"),
        (lambda: step_covariance(np.eye(2), -np.eye(2), 1.0), "density"),
        (lambda: step_covariance(np.eye(2), np.eye(2), 0.0), "dt: must be > 0 s, got 0.0"),
        (lambda: double_integrator_noise(1.0, 4), "dimension: must be 2 or 3, got 4"),
        (lambda: double_integrator_noise(1.0, 2, -0.1), "acceleration: must be >= 0"),
        (lambda: double_integrator_noise(1.0, 2, velocity=[1.0] * 3), "velocity"),
    ],
)
def test_densities_that_are_none_are_refused_by_name(call: object, told: str) -> None:
    with pytest.raises(ScenarioError, match=told):
        call()
