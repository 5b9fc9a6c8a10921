from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scenario_strategies import plans, scenarios

from comparing import differences
from radmpc.io.native.plan_file import load_plan, save_plan
from radmpc.io.native.scenario_file import load_scenario, save_scenario
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from sampling import examples

often = settings(
    max_examples=examples(90),
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("round_trips")


@pytest.mark.slow
@often
@given(scenario=scenarios(), suffix=st.sampled_from([".yaml", ".yml", ".json"]))
def test_a_scenario_survives_a_file_bit_for_bit(
    folder: Path, scenario: Scenario, suffix: str
) -> None:
    path = folder / f"scenario{suffix}"
    save_scenario(scenario, path)
    assert differences(load_scenario(path), scenario) == []


@pytest.mark.slow
@often
@given(plan=plans())
def test_a_plan_survives_a_file_bit_for_bit(folder: Path, plan: Plan) -> None:
    path = folder / "plan.json"
    save_plan(plan, path)
    assert differences(load_plan(path), plan) == []
