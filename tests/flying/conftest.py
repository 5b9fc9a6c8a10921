"""A plan of two vehicles that missions fly."""

import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.result import Result


@pytest.fixture(scope="module")
def result() -> Result:
    return radmpc.plan(paper(2, seed=1), rng=0)
