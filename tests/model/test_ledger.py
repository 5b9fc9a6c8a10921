from __future__ import annotations

import math

import numpy as np
import pytest

from radmpc.model.ledger import bound_text, bound_texts, hazards, risk_by_vehicle
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
    [
        (0.0125, "0.0125"),
        (1.0, "1"),
        (1.00003, "1"),
        (4.0, "1 (the bounds sum to 4)"),
        (0.0, "0"),
        (1e-300, "1e-300"),
        (0.049941, "0.04995"),
    ],
)
def test_a_probability_is_never_said_to_exceed_one(certified: float, text: str) -> None:
    assert bound_text(certified) == text


@pytest.mark.parametrize(
    ("certified", "bound", "texts"),
    [
        (0.04995, 0.05, ("0.04995", "0.05")),
        (0.05, 0.05, ("0.05", "0.05")),
        (0.05 + 1e-12, 0.05, ("0.05001", "0.05")),
        (0.03123454, 0.03123456, ("0.0312346", "0.0312346")),
        (0.03123457, 0.03123456, ("0.03124", "0.0312346")),
        (0.031234561, 0.03123456, ("0.03124", "0.0312346")),
        (4.0, 0.05, ("1 (the bounds sum to 4)", "0.05")),
        (5e-301, 1e-300, ("5e-301", "1e-300")),
    ],
)
def test_a_certificate_is_told_on_the_side_of_the_bound_that_it_is_on(
    certified: float, bound: float, texts: tuple[str, str]
) -> None:
    assert bound_texts(certified, bound) == texts


def test_no_certificate_is_told_on_the_wrong_side_of_its_bound() -> None:
    rng = np.random.default_rng(0)
    for bound in rng.uniform(0.0, 0.5, 200).tolist():
        for near in bound * (1.0 + 10.0 ** rng.uniform(-16.0, -1.0, 4) * rng.choice([-1, 1], 4)):
            told, limit = map(float, bound_texts(float(near), bound))
            assert (told <= limit) == (near <= bound)
            assert told >= near
