"""Sets handed out to workers."""

from __future__ import annotations

import pickle

import numpy as np

from radmpc.experiments.families import fleet
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.problem import Order, advance
from radmpc.planners.certified.set_searches import _shared_out
from radmpc.solvers.solution import Limits, never


def test_the_largest_sets_are_handed_out_first_and_alone():
    sizes = [1, 5, 2, 1, 3, *[1] * 60]
    parts = _shared_out(sizes)
    assert parts[:2] == [[1], [4]]
    assert sorted(i for part in parts for i in part) == list(range(len(sizes)))
    assert max(map(len, parts)) <= 4


def test_nothing_is_handed_out_where_there_is_nothing():
    assert _shared_out([]) == []


def test_a_program_that_was_sent_is_searched_to_the_same_end():
    limits = Limits(float("inf"), never)
    made = Fleet.of(fleet(8, 0), 1e-3, limits)
    order = Order(made.unit, 1.0, 1e-3, 1.0, 40)
    for members in ((0,), (2, 5)):
        problem, alone = made.programs.problem(members), made.programs.alone(members)
        sent = pickle.loads(pickle.dumps(problem))
        here, there = (advance(p, alone, None, order, limits) for p in (problem, sent))
        assert here.best is not None
        assert there.bound == here.bound
        np.testing.assert_array_equal(there.best.z, here.best.z)
