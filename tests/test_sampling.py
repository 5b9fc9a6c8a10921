"""The sample that every check runs of a long list of cases."""

from __future__ import annotations

from sampling import drawn

CASES = [f"test_it[{n}]" for n in range(20)]


def test_a_sample_is_drawn_alike_by_all_workers_and_its_seed_decides_it() -> None:
    assert len(drawn(CASES, 5, 0)) == 5
    assert drawn(CASES, 5, 0) == drawn(CASES, 5, 0) < set(CASES)
    assert len({frozenset(drawn(CASES, 5, seed)) for seed in range(10)}) > 5


def test_every_case_is_in_some_sample() -> None:
    assert set().union(*(drawn(CASES, 5, seed) for seed in range(100))) == set(CASES)


def test_a_list_shorter_than_its_sample_is_run_whole() -> None:
    assert drawn(CASES[:3], 5, 0) == set(CASES[:3])
