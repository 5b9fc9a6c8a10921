from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_plans import FLIGHT, HARBOR, contents, means, plan_of, renamed, written

from radmpc.model.plan import Plan


def rows(plan: Plan) -> list[dict[str, str]]:
    """The lines of a plan's table."""
    text = contents(plan, "csv")["fleet.csv"].decode("utf-8")
    return list(csv.DictReader(StringIO(text, newline="")))


def test_tables_have_a_line_per_vehicle_and_step() -> None:
    found = rows(plan_of(HARBOR))
    assert list(found[0]) == [
        "t", "name", "x", "y", "vx", "vy", "three_sigma_x", "three_sigma_y", "u1", "u2"
    ]  # fmt: skip
    assert [row["name"] for row in found] == ["tug"] * 7 + ["pilot 7"] * 7
    assert [float(row["t"]) for row in found] == [20.0 * step for step in range(7)] * 2


@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_numbers_read_back_equal(content: dict[str, Any]) -> None:
    plan = plan_of(content)
    d = plan.scenario.dimension
    for part in plan.trajectories:
        own = [row for row in rows(plan) if row["name"] == part.name]
        table = np.array([[float(row[key]) for key in [*"xyz"[:d]]] for row in own])
        assert (table == means(plan, part.name)).all()
        speeds = np.array([[float(row[f"v{axis}"]) for axis in "xyz"[:d]] for row in own])
        assert (speeds == part.means[:, d:]).all()
        pushes = [[row[f"u{i + 1}"] for i in range(d)] for row in own]
        assert np.array_equal(np.array(pushes[:-1], dtype=float), part.controls)
        assert pushes[-1] == [""] * d
        sigma = 3.0 * np.sqrt(np.array([np.diag(c)[:d] for c in part.covariances]))
        found = [[float(row[f"three_sigma_{axis}"]) for axis in "xyz"[:d]] for row in own]
        assert np.array(found) == pytest.approx(sigma)


def test_what_a_vehicle_does_not_have_is_empty() -> None:
    single = HARBOR["vehicles"][0] | {
        "name": "drifter",
        "start": [0, 0],
        "dynamics": {"A": [[1, 0], [0, 1]], "B": [[1], [1]], "position": [0, 1]},
        "goal": {"center": [0, 0], "half_width": 9000, "speed": None},
        "initial_covariance": 1.0,
        "disturbance_covariance": 1.0,
    }
    plan = plan_of(HARBOR, vehicles=[single, HARBOR["vehicles"][1]])
    first = rows(plan)[0]
    assert (first["vx"], first["vy"]) == ("", "")
    assert first["u1"] != ""
    assert first["u2"] == ""


def test_names_with_commas_and_quotes_come_back() -> None:
    name = 'a,"b"; c'
    assert {row["name"] for row in rows(renamed(plan_of(HARBOR), "tug", name))} == {name, "pilot 7"}


@pytest.mark.filterwarnings("ignore")  # of the library's own
def test_pandas_reads_the_table(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    plan = plan_of(FLIGHT)
    (file,) = written(plan, "csv", tmp_path)
    table = pandas.read_csv(file, float_precision="round_trip")
    assert (table[["x", "y", "z"]].to_numpy() == means(plan, "scout")).all()
    assert table["u1"].isna().tolist() == [False] * 5 + [True]


@pytest.mark.parametrize("drift", [{"velocity": [0.4, -0.3]}, {"state": [6.0, 2.0, 0.6, 0.0]}])
def test_velocities_are_those_over_ground(drift: dict[str, Any]) -> None:
    """Half the sum of both velocities is the way of a step, whatever carries the vehicle."""
    tug = HARBOR["vehicles"][0] | {"drift": drift}
    plan = plan_of(HARBOR, vehicles=[tug, HARBOR["vehicles"][1]])
    own = [row for row in rows(plan) if row["name"] == "tug"]
    places, speeds = (
        np.array([[float(row[key]) for key in keys] for row in own])
        for keys in (("x", "y"), ("vx", "vy"))
    )
    assert np.diff(places, axis=0) == pytest.approx(10.0 * (speeds[1:] + speeds[:-1]))
    assert not np.allclose(speeds, plan.trajectories[0].means[:, 2:])
