"""Student's t as a sum of Gaussians, against quadrature over the angle and over the factor."""

import tracemalloc

import numpy as np
import pytest
from scipy.special import stdtr
from scipy.stats import chi2

from radmpc.referee.bound.mixture import exceeds_alone_mixed, exceeds_alone_under, mixture_of

SAMPLES = [3, 4, 11, 30, 200, 5000, 1_000_000]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


def by_quadrature(a, b, correlation, samples):
    """Integrate the density of two Student's variables over correlations, from ρ to 1."""
    until = np.log(np.arccos(correlation))
    marks = np.linspace(until - 40.0, until, 1200)
    widths = np.diff(marks)[:, None]
    angle = np.exp(marks[:-1, None] + widths * (1.0 + _NODES) / 2.0)
    half = (a - b) ** 2 / (2.0 * np.sin(angle) ** 2) + a * b / (1.0 + np.cos(angle))
    density = angle * np.exp(-0.5 * samples * np.log1p(2.0 * half / samples))
    between = stdtr(samples, -b) - stdtr(samples, -a)
    return max(0.0, between) + float((density * _WEIGHTS * widths).sum() / (4.0 * np.pi))


def triples(count):
    rng = np.random.default_rng(1)
    a = rng.uniform(-1.0, 6.0, count)
    b = np.clip(a + rng.normal(0.0, 0.7, count), -1.0, 7.0)
    return a, b, np.cos(rng.uniform(0.01, 1.2, count) ** 2)


@pytest.mark.parametrize("samples", SAMPLES)
def test_an_event_without_the_one_before_is_bounded_from_both_sides(samples):
    a, b, correlation = triples(120)
    above, below = exceeds_alone_mixed(a, b, correlation, samples)
    limits = zip(a, b, correlation, strict=True)
    true = np.array([by_quadrature(*each, samples) for each in limits])
    own = stdtr(samples, -b)
    assert np.all(above >= true * (1.0 - 1e-9))
    assert np.all(above <= 1.02 * true + 1e-4 * own)
    assert np.all(below <= 1.017 * true * (1.0 + 1e-9))
    large = true > 0.1 * own
    assert large.sum() > 60
    assert np.all(below[large] >= 0.99 * true[large])


@pytest.mark.parametrize("samples", SAMPLES)
def test_the_sum_is_the_tail_but_for_its_share(samples):
    levels = np.array([-3.0, 0.0, 1.0, 2.5, 4.0, 6.0])
    mixture = mixture_of(samples)
    # Nothing has happened before: the event is charged whole.
    found, least = exceeds_alone_mixed(np.full(6, np.inf), levels, np.zeros(6), samples)
    assert found == pytest.approx(stdtr(samples, -levels), rel=2e-3)
    assert np.all(found <= stdtr(samples, -levels))
    assert np.all(least <= stdtr(samples, -levels) * (1.0 + 1e-9))
    assert 0.0 < mixture.share < 2e-3
    assert mixture.lost < 1e-17


@pytest.mark.parametrize("samples", SAMPLES)
def test_weights_are_those_of_the_factor(samples):
    mixture = mixture_of(samples)
    assert mixture.weights.sum() == pytest.approx(1.0, abs=mixture.share)
    mean = float(mixture.weights @ np.square(mixture.roots))
    assert mean == pytest.approx(1.0, abs=mixture.share)
    low, high = samples * np.square(mixture.roots[[0, -1]])
    assert chi2.cdf(low, samples) < 1e-14
    assert chi2.sf(high, samples) < 1e-2


def test_without_samples_deviations_are_gaussian():
    limits = np.array([2.0]), np.array([3.0]), np.array([0.7])
    known = exceeds_alone_under(None, *limits)
    assert exceeds_alone_under(1_000_000, *limits) == pytest.approx(known, rel=3e-3)
    assert exceeds_alone_under(10, *limits) > 2.0 * known


def test_many_events_take_little_memory_and_come_to_the_same_as_few():
    rng = np.random.default_rng(2)
    count, few = 40_000, slice(19_990, 20_010)
    b = rng.uniform(0.0, 30.0, count)
    limits = b + rng.normal(0.0, 1.0, count), b, rng.uniform(0.5, 1.0, count)
    alone = exceeds_alone_mixed(*(each[few] for each in limits), 3)
    tracemalloc.start()
    try:
        together = exceeds_alone_mixed(*limits, 3)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 40e6
    for one, other in zip(together, alone, strict=True):
        assert np.array_equal(one[few], other)
