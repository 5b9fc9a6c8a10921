"""Prediction matrices over long horizons."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.program.condensed import PredictionMatrices

RNG = np.random.default_rng(3)
SYSTEMS = [
    double_integrator(0.5, 2),
    double_integrator(0.1, 3),
    LinearSystem(0.4 * RNG.normal(size=(5, 5)), RNG.normal(size=(5, 3)), (3, 1), (0, 2)),
    LinearSystem(np.eye(2), RNG.normal(size=(2, 1)), (0, 1), None),
]


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("horizon", [1, 2, 9])
def test_prediction_matrices_lead_where_the_system_does(system: LinearSystem, horizon: int) -> None:
    matrices = PredictionMatrices.of(system, horizon)
    controls = RNG.normal(size=(horizon, system.num_controls))
    states = [np.zeros(system.num_states)]
    for control in controls:
        states.append(system.A @ states[-1] + system.B @ control)
    reached = np.array(states)
    assert matrices.states @ controls.ravel() == pytest.approx(reached)
    places = matrices.position @ controls.ravel()
    assert places == pytest.approx(reached[:, list(system.position)])
    if system.velocity is None:
        assert matrices.velocity is None
    else:
        speeds = matrices.velocity @ controls.ravel()
        assert speeds == pytest.approx(reached[:, list(system.velocity)])


def test_prediction_matrices_take_little_more_than_what_they_hold() -> None:
    system, horizon = double_integrator(0.5, 2), 300
    tracemalloc.start()
    matrices = PredictionMatrices.of(system, horizon)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert matrices.velocity is not None
    held = matrices.position.nbytes + matrices.velocity.nbytes
    assert most < 1.6 * held
