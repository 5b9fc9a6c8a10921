"""What a lattice search keeps of its values."""

from __future__ import annotations

import numpy as np

from radmpc.planners.certified.lattice.tables import INFEASIBLE, FeasibleValues


def test_feasible_values_come_back_as_they_were_and_the_others_infeasible() -> None:
    rng = np.random.default_rng(1)
    values = rng.uniform(0.0, 9.0, (3, 3, 5, 7)).astype(np.float32)
    is_blocked = rng.random(values.shape) < 0.8
    values[is_blocked] = INFEASIBLE + rng.uniform(0.0, 9.0, int(is_blocked.sum()))
    kept = FeasibleValues.of(values)
    assert kept.values.size == values.size - is_blocked.sum()
    whole = kept.whole()
    np.testing.assert_array_equal(whole[~is_blocked], values[~is_blocked])
    np.testing.assert_array_equal(whole == INFEASIBLE, is_blocked)
