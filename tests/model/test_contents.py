"""What is in values: equal to the last bit, or different."""

from __future__ import annotations

import numpy as np
import pytest

import radmpc
from radmpc.model.noise.contents import Keyed, contents
from radmpc.model.vehicle import Vehicle
from radmpc.records import replace
from radmpc.referee.loop import loop_of


def boat(**changes: object) -> Vehicle:
    """A vehicle that measures its place and steers by that, each time made of arrays of its own."""
    system = radmpc.double_integrator(1.0, 2)
    made = radmpc.Vehicle(
        "boat", system, np.zeros(4), radmpc.Goal([8.0, 8.0], [9.0, 9.0], None), 0.5, np.ones(2),
        0.01 * np.eye(4), 0.001 * np.eye(4), gain=radmpc.lqr_gain(system, np.eye(4), np.eye(2)),
        measurement=radmpc.Measurement.of([0, 1], 4, 0.04),
    )  # fmt: skip
    return replace(made, **changes)


NOISES = {
    "initial_covariance": 0.02 * np.eye(4),
    "disturbance_covariance": np.nextafter(0.001, 1.0) * np.eye(4),
    "disturbance_correlation": 0.3,
    "measurement": radmpc.Measurement.of([0, 1], 4, 0.05),
    "shared": (radmpc.SharedDisturbance("wind", np.eye(4), 1e-3 * np.eye(4)),),
    "gain": np.zeros((2, 4)),
    "system": radmpc.double_integrator(0.5, 2),
}


def test_values_of_equal_fields_have_equal_contents_and_hashes():
    one, other = (contents((boat().system, boat().noise, boat().gain)) for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    assert Keyed(1, one) == Keyed(2, other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (np.zeros(4), np.zeros((2, 2))),
        (np.zeros(2), np.zeros(2, dtype=int)),
        (np.array([0.1]), np.array([np.nextafter(0.1, 1.0)])),
        ((1.0, None), (1.0, 0.0)),
        (("a", ("b",)), (("a", "b"),)),
        (radmpc.Goal([0, 0], [1, 1], None), radmpc.Goal([0, 0], [1, 1.5], None)),
    ],
)
def test_whatever_differs_tells_them_apart(one, other):
    assert contents(one) != contents(other)


def test_what_cannot_be_compared_is_refused():
    with pytest.raises(TypeError):
        contents(({"a": 1},))


def test_vehicles_that_are_shaken_and_steered_alike_share_what_noise_makes_of_them():
    one, other = boat(), boat(name="other", radius=0.2, start=np.ones(4))
    assert loop_of(one, 7) is loop_of(other, 7)
    assert one.spread(7) is other.spread(7)
    assert loop_of(one, 8) is not loop_of(one, 7)


@pytest.mark.parametrize("key", NOISES)
def test_one_that_differs_in_its_noise_has_covariances_of_its_own(key):
    one, other = boat(), boat(**{key: NOISES[key]})
    assert loop_of(one, 7) is not loop_of(other, 7)
    assert one.spread(7) is not other.spread(7)
    assert not np.array_equal(one.covariances(7), other.covariances(7))
