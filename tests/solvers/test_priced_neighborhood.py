"""Planning some blocks around others that stay: the part agrees with the whole."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import circle, paper
from radmpc.program.build import build_program, condensed_models
from radmpc.program.restrict import avoidance_blocks, restrict_around
from radmpc.solvers.priced.neighborhood import Neighborhood
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

UNIT = 0.05
PRICE = 0.2


def program_of(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def alone(program):
    """Return every block's solution without the others, and their values."""
    z, values = np.zeros(program.num_columns), []
    touched = avoidance_blocks(program)
    for block in range(touched.shape[1]):
        part = restrict_around(program, np.array([block]), np.array([], dtype=int), z, touched)
        tree = RiskTree(part.program, UNIT, PRICE, gap=1e-3, scale=PRICE, limits=Limits())
        tree.run(1_000)
        z[part.columns] = tree.best.z
        values.append(tree.value)
    return z, values


def neighborhood(program, values):
    return Neighborhood(program, UNIT, PRICE, PRICE, Limits(), 3.0, values)


@pytest.mark.parametrize("seed", range(4))
def test_risks_around_placed_blocks_are_those_of_the_whole(seed):
    program = program_of(paper(4, seed))
    z, _ = alone(program)
    z = neighborhood(program, [0.0] * 4).place(z, range(4))
    whole = Rater(program, UNIT).rate(z)
    touched = avoidance_blocks(program)
    free, placed = np.array([1, 2]), np.array([0, 3])
    part = restrict_around(program, free, placed, z, touched)
    rating = Rater(part.program, UNIT).rate(z[part.columns])
    kept = touched[:, free].sum(axis=1) > 0.0
    assert rating.risk == pytest.approx(whole.cheapest[np.ravel(kept)].sum(), abs=1e-9)
    assert set(part.avoidances) <= set(np.flatnonzero(np.ravel(kept)))


@pytest.mark.parametrize("scenario", [circle(6), paper(8, 3), paper(8, 5)], ids=lambda s: s.name)
def test_placing_blocks_one_by_one_gives_a_solution_of_the_whole(scenario):
    program = program_of(scenario)
    z, values = alone(program)
    found = neighborhood(program, values).place(z, range(len(values)))
    rating = Rater(program, UNIT).rate(found)
    assert rating.largest <= UNIT * (1.0 + 1e-6)
    assert np.all(program.hard @ found <= program.hard_upper + 1e-6)
    assert np.all(program.hard @ found >= program.hard_lower - 1e-6)
    assert float(program.cost @ found) + PRICE * rating.risk / UNIT >= sum(values) * (1 - 1e-3)


def test_improving_never_makes_a_solution_worse():
    program = program_of(circle(6))
    z, values = alone(program)
    around = neighborhood(program, values)
    before = around.place(z, range(6))
    after = around.improve(before, [[i] for i in range(6)])
    rater = Rater(program, UNIT)

    def value(point):
        return float(program.cost @ point) + PRICE * rater.rate(point).risk / UNIT

    assert value(after) <= value(before) + 1e-9
