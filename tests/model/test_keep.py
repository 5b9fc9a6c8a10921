from __future__ import annotations

import pytest

from radmpc import Goal, Keep, Scenario, ScenarioError, Vehicle, double_integrator
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.relations.keep import keep_pairs


def vehicle(name: str, y: float) -> Vehicle:
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=[0.0, y],
        goal=Goal.at([10.0, y], 0.5),
        radius=0.3,
        control_limit=2.0,
        initial_covariance=0.0,
        disturbance_covariance=0.0,
    )


def fleet(*keep: Keep) -> Scenario:
    vehicles = [vehicle(name, 3.0 * i) for i, name in enumerate("abc")]
    return Scenario("ranges", 1.0, 8, 0.01, vehicles, keep=keep)


def test_ranges_are_read_back_as_they_were_written() -> None:
    given = fleet(Keep(["b", "a"], 4.5), Keep(["b", "c"], 7))
    read = from_dict(to_dict(given))
    assert isinstance(read, Scenario)
    assert read.keep == given.keep == (Keep(("b", "a"), 4.5), Keep(("b", "c"), 7.0))


def test_pairs_are_named_by_their_places_lower_first() -> None:
    given = fleet(Keep(["b", "a"], 4.5), Keep(["b", "c"], 7.0))
    assert keep_pairs(given.keep, ["a", "b", "c"]) == ((0, 1, 4.5), (1, 2, 7.0))
    assert keep_pairs(given.keep, ["c", "b"]) == ((0, 1, 7.0),)


def test_a_part_of_a_fleet_keeps_the_ranges_between_its_own() -> None:
    given = fleet(Keep(["a", "b"], 4.5), Keep(["b", "c"], 7.0))
    assert given.subset([1, 2], 0.01).keep == (given.keep[1],)
    assert given.subset([0, 2], 0.01).keep == ()


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"vehicles": ["a", "d"], "within": 4}, r"^keep\[1\]\.vehicles\[1\]: .* got 'd'"),
        ({"vehicles": ["a", "a"], "within": 4}, r"^keep\[1\]\.vehicles: must name two vehicles"),
        ({"vehicles": ["b", "a"], "within": 4}, r"^keep\[1\]\.vehicles: repeats the pair"),
        ({"vehicles": ["a", "c"], "within": 0}, r"^keep\[1\]\.within: must be > 0 m, got 0$"),
        ({"vehicles": ["a", "c"]}, r"^keep\[1\]\.within: "),
        ({"vehicles": ["a"], "within": 4}, r"^keep\[1\]\.vehicles: "),
    ],
)
def test_wrong_ranges_are_refused_with_their_place(entry: dict[str, object], message: str) -> None:
    data = to_dict(fleet(Keep(["a", "b"], 4.5)))
    kept = data["keep"]
    assert isinstance(kept, list)
    with pytest.raises(ScenarioError, match=message):
        from_dict({**data, "keep": [*kept, entry]})


def test_what_is_no_range_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"^keep\[0\]: must be a Keep, got"):
        fleet(("a", "b", 4.0))  # type: ignore[arg-type]  # what a caller may try
