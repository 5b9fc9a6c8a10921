"""What holds for every scenario, plan and result as a value."""

from __future__ import annotations

import base64
import copy
import io
import json
import pickle
import re
import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from PIL import Image

import radmpc
from radmpc import (
    Goal,
    LinearSystem,
    Trajectory,
    Vehicle,
    from_dict,
    load_scenario,
    plan,
    save_export,
    to_dict,
    to_pandas,
    to_xarray,
)
from radmpc.experiments.families import paper
from radmpc.notebook import lacking_signs, listed

HARBOR = "src/radmpc/data/harbor.yaml"


@pytest.fixture(scope="module")
def result() -> radmpc.Result:
    return plan(paper(3, seed=1), rng=0)


def arrays(value: object, depth: int = 0) -> list[np.ndarray]:
    """All arrays inside a value."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, tuple | list):
        return [a for entry in value for a in arrays(entry, depth)]
    names = getattr(type(value), "__slots__", ())
    return [a for name in names for a in arrays(getattr(value, name, None), depth + 1)]


@pytest.mark.parametrize("again", [copy.deepcopy, lambda v: pickle.loads(pickle.dumps(v))])
def test_copies_and_pickles_are_equal_and_as_frozen_as_what_they_came_from(result, again) -> None:
    for value in (result.plan.scenario, result.plan, result):
        assert arrays(value)
        made = again(value)
        for one, two in zip(arrays(value), arrays(made), strict=True):
            assert np.array_equal(one, two)
            assert not two.flags.writeable
    made = again(result)
    assert made.certificate.certified == result.certificate.certified
    assert to_dict(made.record) == to_dict(result.record)


def test_scenarios_with_every_kind_of_obstacle_pickle() -> None:
    scenario = load_scenario(HARBOR)
    assert to_dict(pickle.loads(pickle.dumps(scenario))) == to_dict(scenario)


def test_plain_data_survive_json_and_make_an_equal_value(result) -> None:
    for value in (result.plan.scenario, result.plan):
        data = json.loads(json.dumps(to_dict(value)))
        made = from_dict(data)
        assert type(made) is type(value)
        assert to_dict(made) == to_dict(value)


@pytest.mark.parametrize("data", [{}, {"format": "radmpc/plan/9"}, {"format": 3}, [1], "x"])
def test_data_of_no_known_format_are_refused(data) -> None:
    with pytest.raises(radmpc.ScenarioError, match="must be"):
        from_dict(data)


def test_a_table_holds_every_vehicle_and_step(result) -> None:
    made, table = result.plan, to_pandas(result.plan)
    assert len(table) == 3 * (made.scenario.horizon + 1)
    first = made.trajectories[0]
    rows = table.loc[first.name]
    np.testing.assert_array_equal(rows[["x", "y"]], first.means[:, :2])
    np.testing.assert_array_equal(rows[["vx", "vy"]], first.means[:, 2:])
    np.testing.assert_array_equal(rows[["u1", "u2"]].iloc[:-1], first.controls)
    assert rows[["u1", "u2"]].iloc[-1].isna().all()
    np.testing.assert_allclose(rows["three_sigma_x"] ** 2, 9.0 * first.covariances[:, 0, 0])
    assert np.abs(table[["u1", "u2"]]).sum().sum() == pytest.approx(result.cost)


@pytest.mark.filterwarnings("ignore")  # of pandas' own reader
def test_a_table_and_a_csv_file_have_the_same_columns_and_numbers(result, tmp_path) -> None:
    save_export(result.plan, "csv", tmp_path / "plan.csv")
    read = pd.read_csv(tmp_path / "plan.csv", float_precision="round_trip").set_index("name")
    pd.testing.assert_frame_equal(read, to_pandas(result.plan).droplevel("step"), check_exact=True)


def test_a_vehicle_without_velocities_has_none_in_the_table(result) -> None:
    hover = LinearSystem(np.eye(2), np.eye(2), (0, 1), None)
    vehicle = Vehicle("a", hover, [0, 0], Goal.at([0, 0], speed=None), 1.0, 1.0, 0.0, 0.0)
    scenario = replace(result.plan.scenario, vehicles=(vehicle,))
    steps = scenario.horizon + 1
    still = Trajectory("a", np.zeros((steps - 1, 2)), np.zeros((steps, 2)), np.zeros((steps, 2, 2)))
    table = to_pandas(replace(result.plan, scenario=scenario, trajectories=(still,)))
    assert list(table)[:5] == ["t", "x", "y", "vx", "vy"]
    assert table[["vx", "vy"]].isna().all().all()


def test_the_ledger_as_a_table_sums_to_the_certificate(result) -> None:
    table = to_pandas(result.plan, "ledger")
    assert table["risk"].sum() == pytest.approx(result.certificate.certified)
    assert list(table.columns) == ["cause", "vehicle", "other", "step", "risk"]


def test_a_plan_that_is_none_has_an_empty_table_and_no_arrays(result) -> None:
    none = replace(result.plan, trajectories=())
    assert isinstance(to_pandas(none), pd.DataFrame)
    assert to_pandas(none).empty
    with pytest.raises(ValueError, match="needs a plan"):
        to_xarray(none)
    with pytest.raises(ValueError, match="got 'lines'"):
        to_pandas(none, "lines")


def test_labeled_arrays_hold_what_the_plan_holds(result) -> None:
    data = to_xarray(result.plan)
    name = result.plan.trajectories[1].name
    one = data.sel(vehicle=name)
    np.testing.assert_array_equal(one["mean"], result.plan.trajectories[1].means)
    np.testing.assert_array_equal(one["covariance"], result.plan.trajectories[1].covariances)
    np.testing.assert_array_equal(one["control"][:-1], result.plan.trajectories[1].controls)
    assert float(data["time"][-1]) == result.plan.scenario.dt * result.plan.scenario.horizon
    assert list(data["axis"].values) == ["x", "y"]
    assert float(np.abs(data["control"]).sum()) == pytest.approx(data.attrs["cost"])


def test_a_result_shows_a_summary_and_a_picture_in_a_notebook(result) -> None:
    page = result._repr_html_()
    for told in ("optimal", f"{result.cost:.6g}", "within 0.05", "{v"):
        assert told in page
    [data] = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    image = Image.open(io.BytesIO(base64.b64decode(data)))
    assert image.format == "PNG"
    assert image.width > 400


@pytest.mark.filterwarnings("error")
def test_a_picture_in_a_notebook_tells_of_letters_that_the_font_lacks_in_one_line(result) -> None:
    scenario = replace(result.plan.scenario, name="港の計画")
    page = replace(result, record=replace(result.record, scenario=scenario))._repr_html_()
    told = "the font has no sign for の, 港, 画, 計: boxes stand for them"
    assert page.endswith(f"<p>{told}</p>")
    assert result._repr_html_().endswith("/>")


def test_a_fleet_that_stays_costs_nothing_and_not_what_rounding_leaves(result) -> None:
    still = replace(result.plan, cost=4.163e-17, lower_bound=0.0)
    assert "cost 0," in repr(still)
    assert "0 (at least 0)" in repr(replace(result, record=still))


def test_a_plan_that_is_refused_within_its_bound_says_what_it_is_refused_for(result) -> None:
    sound = result.certificate
    one = replace(result, certificate=replace(sound, problems=("v0 misses its goal by 1 m",)))
    assert f", within {sound.bound:g}; refused: v0 misses its goal by 1 m" in repr(one)
    two = replace(result, certificate=replace(sound, problems=("v0 misses its goal", "v1 too")))
    assert "refused: v0 misses its goal (and 1 more)" in repr(two)
    beyond = replace(result, certificate=replace(sound, certified=0.06))
    assert "at most 0.06, NOT within 0.05" in repr(beyond)
    assert "refused" not in repr(beyond)


def test_what_a_notebook_draws_hides_no_other_warning() -> None:
    with pytest.warns(UserWarning, match="the layout failed"), lacking_signs() as lacking:
        warnings.warn("the layout failed", UserWarning, stacklevel=1)
    assert not lacking


def test_scenario_certificate_and_simulation_show_their_facts_in_a_notebook(result) -> None:
    scenario = replace(result.plan.scenario, name="<script>")
    page = scenario._repr_html_()
    assert page.startswith("<table><tr><th")
    for told in ("&lt;script&gt;", "3: v", f"{scenario.risk_bound:g}", "obstacles"):
        assert told in page
    assert "<script>" not in page
    judged = radmpc.certify(result.plan)
    page = judged._repr_html_()
    assert judged.summary in page
    assert f"step {max(judged.ledger, key=lambda row: row.risk).step}" in page
    wrong = replace(judged, problems=("a < b",))._repr_html_()
    assert "a &lt; b" in wrong
    flown = radmpc.simulate(result.plan, 2000, rng=0)
    for told in ("2,000", f"{flown.rate:.3g}", f"to {flown.rate_high:.3g}"):
        assert told in flown._repr_html_()


def test_a_plan_shows_its_facts_in_a_notebook(result) -> None:
    page = result.plan._repr_html_()
    assert page.startswith("<table><tr><th")
    for told in (result.plan.scenario.name, f"{result.cost:.6g}", "at most 0.0", "of 0.05", "{v"):
        assert told in page
    none = plan(paper(2, seed=1), "ira", time_limit=0.0).record
    assert "time limit" in none._repr_html_()


def test_long_lists_are_cut_in_notebooks() -> None:
    names = [f"b{i}" for i in range(10)]
    assert listed(names).endswith("b7 and 2 more")
    assert listed([]) == "none"


def test_a_result_without_a_plan_shows_why() -> None:
    none = plan(paper(2, seed=1), "ira", time_limit=0.0)
    assert none.plan is None
    assert "limit" in none._repr_html_()
    assert "time limit" in repr(none)


def test_values_print_in_one_line(result) -> None:
    for value in (result, result.plan, result.plan.scenario):
        assert "\n" not in repr(value)
        assert len(repr(value)) < 300
    assert "optimal" in repr(result)
    assert "3 vehicles" in repr(result.plan.scenario)


def test_every_public_name_is_there() -> None:
    for name in radmpc.__all__:
        assert getattr(radmpc, name) is not None
    assert set(radmpc.__all__) <= set(dir(radmpc))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = radmpc.nothing
