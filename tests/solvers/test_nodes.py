"""Nodes of both trees: each is in the queue once, whatever takes it and gives it back."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.gaussian import clearance_for
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.tree import Tree
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits


def program_of(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def assert_each_once(nodes):
    numbers = [node.number for _, node in nodes]
    assert len(numbers) == len(set(numbers))


@pytest.mark.slow
@pytest.mark.parametrize("step", [1, 3, 7])
def test_a_priced_search_that_is_stopped_again_and_again_queues_every_node_once(step):
    program = program_of(paper(8, 0).subset((0, 3, 6), 0.05))
    tree = RiskTree(program, 0.05, 0.2, gap=1e-4, scale=1e-3, limits=Limits())
    for _ in range(60):
        tree.run(step)
        assert_each_once(tree._open._heap)
        chosen = [sides for _, sides in tree.frontier]
        assert len(chosen) == len(set(chosen))
    assert tree.nodes >= 60 * step


@pytest.mark.parametrize(("step", "risk"), [(1, 1e-3), (2, 1e-2), (2, 1e-3), (3, 1e-6)])
def test_a_search_at_fixed_margins_that_is_stopped_as_it_backs_up_queues_every_node_once(
    step, risk
):
    program = program_of(clutter(1, 80, 1))
    margins = program.rows.deviations * clearance_for(np.full(program.rows.count, risk))
    tree = Tree(program, margins, gap=1e-6, limits=Limits())
    for _ in range(30):
        tree.run(step)
        assert_each_once(tree._open._heap)
    assert tree.nodes >= 30 * step
