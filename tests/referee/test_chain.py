"""The chain of half-spaces against all choices, one by one."""

from functools import partial
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radmpc.referee.chain import chain_charges, cheapest_chain, run_scores


def cost_of_choice(near, far, choice):
    total = near[0, choice[0]]
    for j in range(1, len(choice)):
        left, right = far[j - 1, choice[j - 1]], near[j, choice[j]]
        total += max(left, right) if choice[j] == choice[j - 1] else left + right
    return total + far[-1, choice[-1]]


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_the_chain_is_the_cheapest_of_all(seed):
    rng = np.random.default_rng(seed)
    near, far = rng.exponential(1.0, (2, 3, 4, 3)) ** 3
    choices = cheapest_chain(near, far)
    for b in range(3):
        best = min(cost_of_choice(near[b], far[b], c) for c in product(range(3), repeat=4))
        assert cost_of_choice(near[b], far[b], choices[b]) == pytest.approx(best, rel=1e-12)


def test_charges_follow_the_runs():
    near = np.array([[1.0, 2.0, 3.0]])
    far = np.array([[5.0, 1.0, 7.0]])
    one_run = np.array([[True, False, False]])
    assert chain_charges(near, far, one_run).tolist() == [[1.0, 5.0, 3.0, 7.0]]
    two_runs = np.array([[True, False, True]])
    assert chain_charges(near, far, two_runs).tolist() == [[1.0, 5.0, 4.0, 7.0]]


def test_scores_of_runs_are_their_charges():
    risks = np.array([[[1.0, 5.0]], [[2.0, 1.0]], [[3.0, 7.0]]])
    score = partial(run_scores, begins=np.array([True, False, True]))
    assert score(risks)[:, 0].tolist() == [7.0, 7.0, 10.0]
