"""Whether going on with a proof promises anything."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from radmpc.experiments.families import fleet
from radmpc.planners.certified.proof.promise import (
    hidden_value,
    is_slow,
    least_worth,
    most_promising_first,
    unsearched_value,
)
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.proof.tuning import TUNING
from radmpc.planning import plan


def test_a_rate_that_does_not_lead_half_way_is_slow() -> None:
    # 1.0 by 100 nodes: 400 more raise it by 4.0 at most.
    assert is_slow(1.0, 100, 400.0, 8.1)
    assert not is_slow(1.0, 100, 400.0, 7.9)
    assert is_slow(0.0, 100, 400.0, 1e-9)


@pytest.mark.parametrize("gain", [0.0, 1e-9, 1.0])
def test_who_has_no_count_of_nodes_is_never_slow(gain: float) -> None:
    assert not is_slow(gain, 100, float("inf"), 8.0)


def test_what_was_left_out_hides_no_more_than_the_plan_pays() -> None:
    sets = {
        (0,): SimpleNamespace(base=3.0, value=3.5, is_complete=False),  # pays 1.0: hides 0.5
        (1,): SimpleNamespace(base=3.0, value=3.5, is_complete=True),
        (2,): SimpleNamespace(base=3.0, value=4.5, is_complete=False),  # worth more than the plan
    }
    assert hidden_value(sets.items(), lambda members: 1.0) == pytest.approx(0.5)


def test_a_part_of_twice_the_vehicles_must_promise_four_times_as_much() -> None:
    paid = {(0,): 1.0, (1, 2): 3.9, (3, 4): 4.1, (5,): 0.5}
    assert most_promising_first(paid, paid.__getitem__) == ((3, 4), (0,), (1, 2), (5,))


def test_a_few_parts_that_promise_little_are_not_searched() -> None:
    worth = least_worth([5.0, 0.01 * TUNING.worth * 10.0], 10.0)
    assert worth == pytest.approx(TUNING.worth * 10.0)


def test_many_parts_that_promise_little_each_are_searched_but_for_a_share_of_the_gap() -> None:
    at_stake = 10.0
    paid = [0.9 * TUNING.worth * at_stake * (k + 1) / 100 for k in range(100)]
    worth = least_worth(paid, at_stake)
    left_out = [each for each in paid if each <= worth]
    assert sum(left_out) <= TUNING.left_out * at_stake
    assert sum(left_out) + min(set(paid) - set(left_out)) > TUNING.left_out * at_stake


def test_parts_that_promise_the_same_are_all_searched_but_not_those_that_pay_nothing() -> None:
    each = 0.1 * TUNING.worth * 10.0
    allowed = TUNING.left_out * 10.0 / each
    few, many = int(0.9 * allowed), int(1.1 * allowed)
    assert least_worth([-1e-12, 0.0] + [each] * few, 10.0) >= each
    assert 0.0 <= least_worth([-1e-12, 0.0] + [each] * many, 10.0) < each


@pytest.mark.slow
@pytest.mark.sampled(1)
def test_a_large_fleets_proof_is_left_where_nodes_do_too_little(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: list[BoundSearch] = []
    run = BoundSearch.run

    def kept(self: BoundSearch) -> None:
        found.append(self)
        run(self)

    monkeypatch.setattr(BoundSearch, "run", kept)
    monkeypatch.setattr(
        "radmpc.planners.certified.proof.search.is_slow", lambda *asked: found[-1].best > 0.0
    )
    result = plan(fleet(64, 0), time_limit=120.0)
    assert result.certified_lower_bound is not None
    assert result.certified_lower_bound <= result.cost


@pytest.mark.parametrize(("unsearched", "is_futile"), [(0.5, True), (4.0, False)])
def test_what_is_not_worth_a_search_promises_nothing(unsearched: float, *, is_futile: bool) -> None:
    """Of 10 open, 6 have to be closed; searched parts leave 3, one was not searched."""
    whole = SimpleNamespace(is_complete=True)
    search = SimpleNamespace(
        order=((0,), (1,)),
        incumbent=SimpleNamespace(cost=100.0),
        bound_here=lambda: 90.0,
        _found=lambda: [((0,), whole)],
        _paid_for_hazards=lambda members: unsearched,
        _left=lambda: 3.0,
        _missing=lambda: 6.0,
        price=2.0,
        fleet=SimpleNamespace(scenario=SimpleNamespace(risk_bound=0.05)),
    )
    assert BoundSearch._is_futile(search, worth=1.0) is is_futile


def test_sets_too_large_for_one_search_may_be_charged_for_their_risk_too() -> None:
    large = tuple(range(TUNING.most_together + 1))
    assert unsearched_value({(0,): 3.0, (1, 2): 0.5}, 1.0, 0.1) == 3.0
    assert unsearched_value({(0,): 3.0, large: 5.0}, 1.0, 0.1) == pytest.approx(8.1)
