"""The bound on one event without another against quadrature, limits and scipy."""

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import multivariate_normal

from radmpc.referee.bound.bivariate import exceeds_alone

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


def density_between(a, b, low, high):
    """Integrate the bivariate density over correlations, in the logarithm of the angle left."""
    until = np.log(np.arccos(low))
    since = np.log(np.arccos(high)) if high < 1.0 else until - 60.0
    marks = np.linspace(0.0, until - since, int(np.ceil(16.0 * (until - since))) + 1)
    widths = np.diff(marks)[:, None]
    angle = np.exp(since + marks[:-1, None] + widths * (1.0 + _NODES) / 2.0)
    exponent = (a - b) ** 2 / (2.0 * np.sin(angle) ** 2) + a * b / (1.0 + np.cos(angle))
    return float((angle * np.exp(-exponent) * _WEIGHTS * widths).sum() / (4.0 * np.pi))


def by_quadrature(a, b, correlation):
    if correlation < 0.0:
        return ndtr(a) * ndtr(-b) + density_between(-a, b, 0.0, -correlation)
    tails = ndtr(-b) - ndtr(-a) if a + b > 0.0 else ndtr(a) - ndtr(b)
    return max(0.0, tails) + density_between(a, b, correlation, 1.0)


def triples(rng, count):
    """Return limits and correlations: ordinary ones, close limits, extreme correlations."""
    a = rng.normal(0.0, 4.0, count)
    b = np.where(rng.random(count) < 0.5, rng.normal(0.0, 4.0, count), a)
    b = b * (1.0 + 10.0 ** rng.uniform(-4.0, 0.0, count) * rng.choice([-1.0, 0.0, 1.0], count))
    b *= np.where(rng.random(count) < 0.2, -1.0, 1.0)
    loss = np.where(rng.random(count) < 0.5, rng.random(count), 10.0 ** rng.uniform(-15, 0, count))
    return a, b, rng.choice([-1.0, 1.0, 1.0], count) * (1.0 - loss)


@pytest.mark.slow
def test_the_bound_is_never_below_and_within_two_percent():
    a, b, correlation = triples(np.random.default_rng(1), 3000)
    found = exceeds_alone(a, b, correlation)
    true = np.array([by_quadrature(*each) for each in zip(a, b, correlation, strict=True)])
    seen = true > 1e-290
    assert seen.sum() > 2500
    # Differences of tails lose digits in the quadrature, not in the bound.
    lost = np.where(np.abs(a - b) < 0.01, 1e-14 * np.minimum(ndtr(-b), ndtr(a)), 0.0)
    assert (found >= true * (1.0 - 1e-12) - lost)[seen].all()
    assert (found <= true * 1.016 + lost)[seen].all()


@pytest.mark.slow
def test_the_bound_is_within_three_permille_where_correlation_is_high():
    rng = np.random.default_rng(2)
    a, b = rng.uniform(0.5, 6.0, (2, 1000))
    b[::2] = a[::2] + 10.0 ** rng.uniform(-9.0, 0.0, 500) * rng.choice([-1.0, 1.0], 500)
    correlation = rng.uniform(0.5, 0.9999, 1000)
    true = np.array([by_quadrature(*each) for each in zip(a, b, correlation, strict=True)])
    assert (exceeds_alone(a, b, correlation) <= 1.003 * true).all()


def test_scipy_agrees():
    for a, b, correlation in [
        (1.0, 0.5, 0.7),
        (-1.0, 1.5, 0.3),
        (0.5, -0.7, -0.6),
        (2.0, 2.0, 0.9),
    ]:
        covariance = [[1.0, -correlation], [-correlation, 1.0]]
        true = multivariate_normal.cdf([a, -b], cov=covariance)
        assert exceeds_alone(a, b, correlation) == pytest.approx(true, rel=0.01)


@pytest.mark.parametrize(
    ("a", "b"), [(1.0, 0.3), (0.3, 1.0), (-2.0, -2.5), (7.0, 6.9), (0.2, -0.3)]
)
def test_limits_of_the_correlation_are_exact(a, b):
    same = max(0.0, ndtr(-b) - ndtr(-a))
    opposite = min(ndtr(a), ndtr(-b))
    found = exceeds_alone(a, b, [1.0, 0.0, -1.0])
    np.testing.assert_allclose(found, [same, ndtr(a) * ndtr(-b), opposite], rtol=1e-10)


def test_close_limits_keep_their_digits_at_full_correlation():
    width = 2.0**-40
    density = np.exp(-0.5 * 3.0**2) / np.sqrt(2.0 * np.pi)
    found = exceeds_alone([3.0 + width, -3.0], [3.0, -3.0 - width], 1.0)
    np.testing.assert_allclose(found, width * density, rtol=1e-10)


def test_a_correlation_rounded_above_one_is_one():
    assert exceeds_alone(2.0, 1.0, 1.0 + 1e-12) == exceeds_alone(2.0, 1.0, 1.0)


def test_a_correlation_not_known_gets_the_smaller_event():
    assert exceeds_alone(-1.0, 0.0, np.nan) == ndtr(-1.0)


def test_a_correlation_of_a_rounding_error_counts_as_none():
    a, tiny = np.array([-3.0, 0.0, 1.0, 7.0]), np.finfo(float).eps
    for correlation in (-0.25 * tiny, -0.5 * tiny, -tiny, 0.25 * tiny, tiny):
        for b in (a, -a):
            found = exceeds_alone(a, b, correlation)
            np.testing.assert_allclose(found, ndtr(a) * ndtr(-b), rtol=1e-9)


def test_infinite_limits_leave_one_event():
    limits = np.array([[np.inf, 1.0], [-np.inf, 1.0], [1.0, np.inf], [1.0, -np.inf]])
    for correlation in (-1.0, -0.4, 0.0, 0.4, 1.0):
        found = exceeds_alone(limits[:, 0], limits[:, 1], correlation)
        np.testing.assert_allclose(found, [ndtr(-1.0), 0.0, 0.0, ndtr(1.0)], rtol=1e-10)


def test_arguments_are_broadcast():
    assert exceeds_alone(np.ones((3, 1)), np.zeros(4), 0.5).shape == (3, 4)
