"""The chain of half-spaces against all choices, one by one."""

from functools import partial
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radmpc.referee.bound.chain import chain_charges, cheapest_chain, run_scores
from sampling import examples


def cost_of_choice(near, far, choice):
    """Sum what one choice of directions costs, step by step; near is (K, C, ends)."""
    own, bent = near[..., 0], near[..., 1:].sum(axis=-1)
    total = own[0, choice[0]] + bent[0, choice[0]]
    for j in range(1, len(choice)):
        left, right = far[j - 1, choice[j - 1]], own[j, choice[j]]
        total += max(left, right) if choice[j] == choice[j - 1] else left + right
        total += bent[j, choice[j]]
    return total + far[-1, choice[-1]]


@settings(max_examples=examples(30), deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2]))
def test_the_chain_is_the_cheapest_of_all(seed, ends):
    rng = np.random.default_rng(seed)
    near = rng.exponential(1.0, (3, 4, 3, ends)) ** 3
    far = rng.exponential(1.0, (3, 4, 3)) ** 3
    choices = cheapest_chain(near, far)
    for b in range(3):
        best = min(cost_of_choice(near[b], far[b], c) for c in product(range(3), repeat=4))
        assert cost_of_choice(near[b], far[b], choices[b]) == pytest.approx(best, rel=1e-12)


def test_charges_follow_the_runs():
    near = np.array([[[1.0], [2.0], [3.0]]])
    far = np.array([[5.0, 1.0, 7.0]])
    one_run = np.array([[True, False, False]])
    assert chain_charges(near, far, one_run).tolist() == [[1.0, 5.0, 3.0, 7.0]]
    two_runs = np.array([[True, False, True]])
    assert chain_charges(near, far, two_runs).tolist() == [[1.0, 5.0, 4.0, 7.0]]


def test_what_feedback_makes_of_a_deviation_is_charged_whatever_the_runs():
    near = np.array([[[1.0, 0.5], [2.0, 0.25], [3.0, 0.125]]])
    far = np.array([[5.0, 1.0, 7.0]])
    one_run = np.array([[True, False, False]])
    assert chain_charges(near, far, one_run).tolist() == [[1.5, 5.25, 3.125, 7.0]]
    two_runs = np.array([[True, False, True]])
    assert chain_charges(near, far, two_runs).tolist() == [[1.5, 5.25, 4.125, 7.0]]


def test_scores_of_runs_are_their_charges():
    risks = np.array([[[1.0, 5.0]], [[2.0, 1.0]], [[3.0, 7.0]]])
    score = partial(run_scores, begins=np.array([True, False, True]))
    assert score(risks)[:, 0].tolist() == [7.0, 7.0, 10.0]


@settings(max_examples=examples(20), deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from([2, 3]))
def test_scores_of_runs_add_up_to_what_the_chain_charges(seed, ends):
    rng = np.random.default_rng(seed)
    risks = rng.exponential(1.0, (5, 1, ends))
    begins = np.array([True, *(rng.random(4) < 0.5)])
    scores = run_scores(risks, begins)[:, 0]
    charged = chain_charges(risks[None, :, 0, :-1], risks[None, :, 0, -1], begins[None])
    assert scores[begins].sum() == pytest.approx(charged.sum(), rel=1e-12)
