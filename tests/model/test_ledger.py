from __future__ import annotations

import math

import pytest

from radmpc.model.ledger import bound_text, hazards, risk_by_vehicle
from radmpc.model.plan import LedgerRow

ROWS = (
    LedgerRow("obstacle", "a", "reef", 2, 0.001),
    LedgerRow("pair", "a", "b", 1, 0.01),
    LedgerRow("pair", "a", "b", 3, 0.02),
    LedgerRow("pair", "b", None, 0, 1e-18),
    LedgerRow("workspace", "b", None, 2, 0.004),
)


def test_steps_of_one_cause_are_one_hazard_the_largest_first() -> None:
    found = hazards(ROWS)
    assert [(e.cause, e.vehicle, e.other) for e in found] == [
        ("pair", "a", "b"),
        ("workspace", "b", None),
        ("obstacle", "a", "reef"),
        ("pair", "b", None),
    ]
    assert found[0].risks == {1: 0.01, 3: 0.02}
    assert found[0].total == pytest.approx(0.03)


def test_rows_of_the_same_step_add_up() -> None:
    (one,) = hazards((ROWS[0], ROWS[0]))
    assert one.risks == {2: 0.002}


def test_both_of_a_pair_bear_half_and_nothing_is_lost() -> None:
    parts = risk_by_vehicle(ROWS, ["a", "b", "c"])
    assert list(parts) == ["a", "b", "c"]
    assert parts["a"] == dict(pair=pytest.approx(0.015), obstacle=0.001, workspace=0.0, range=0.0)
    assert parts["b"]["pair"] == pytest.approx(0.015)
    assert sum(parts["c"].values()) == 0.0
    total = math.fsum(risk for causes in parts.values() for risk in causes.values())
    assert total == pytest.approx(sum(row.risk for row in ROWS))


def test_what_is_far_away_is_borne_by_the_one_it_is_charged_with() -> None:
    assert risk_by_vehicle(ROWS[3:4], ["a", "b"])["b"]["pair"] == 1e-18


@pytest.mark.parametrize(
    ("certified", "text"),
    [(0.0125, "0.0125"), (1.0, "1"), (1.00003, "1"), (4.0, "1 (the bounds sum to 4)")],
)
def test_a_probability_is_never_said_to_exceed_one(certified: float, text: str) -> None:
    assert bound_text(certified) == text
