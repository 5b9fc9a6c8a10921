"""Noise, sensors and sources in scenario files."""

from pathlib import Path

import numpy as np
import pytest
from bare_scenario import bare

from comparing import differences
from radmpc.errors import ScenarioError
from radmpc.io.native.scenario_file import (
    decode_scenario,
    encode_scenario,
    load_scenario,
    save_scenario,
)


def test_the_example_of_the_documentation_is_valid(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    path = tmp_path / "example.yaml"
    path.write_text(text.split("```yaml\n")[1].split("```")[0], encoding="utf-8")
    scenario = load_scenario(path)
    assert (scenario.num_vehicles, len(scenario.obstacles)) == (2, 3)


def test_a_default_that_fits_not_every_vehicle_names_the_one() -> None:
    data = bare()
    dynamics = {"A": [[1, 0], [0, 1]], "B": [[1, 0], [0, 1]], "position": [0, 1]}
    (vehicle,) = data["vehicles"]
    data["vehicles"] = [vehicle, {**vehicle, "name": "b", "dynamics": dynamics}]
    data["defaults"] = {"initial_covariance": [1, 1, 1, 1]}
    with pytest.raises(ScenarioError) as caught:
        decode_scenario(data)
    assert str(caught.value) == (
        "defaults.initial_covariance: must have 2 numbers, got 4 (for vehicle 'b')"
    )


@pytest.mark.nightly
@pytest.mark.slow
def test_a_file_of_a_thousand_vehicles_is_written_and_read(tmp_path: Path) -> None:
    data = bare()
    (vehicle,) = data["vehicles"]
    data["vehicles"] = [{**vehicle, "name": f"v{i}", "start": [i, -i]} for i in range(1000)]
    scenario = decode_scenario(data)
    for suffix in (".yaml", ".json"):
        save_scenario(scenario, tmp_path / f"many{suffix}")
        assert differences(load_scenario(tmp_path / f"many{suffix}"), scenario) == []


def nested(levels: int) -> dict[str, object]:
    """Mappings and lists in one another."""
    value: dict[str, object] = {}
    for _ in range(levels):
        value = {"a": [value]}
    return value


@pytest.mark.parametrize(
    ("source", "line"),
    [
        (nested(40), r"source: must not be nested deeper than 20 levels"),
        ({"a": {1: 2}}, r"source.a: keys must be text, got 1"),
        ({"a": b"x"}, r"source.a: must be plain data, got b'x'"),
    ],
)
def test_a_source_that_no_file_can_hold_is_refused(source: object, line: str) -> None:
    with pytest.raises(ScenarioError, match=line):
        decode_scenario({**bare(), "source": source})


def _two(**defaults: object) -> dict[str, object]:
    """Return a file's content: two vehicles with defaults."""
    return {
        "format": "radmpc/scenario/1",
        "name": "s",
        "dt": 0.5,
        "horizon": 4,
        "risk_bound": 0.05,
        "defaults": {"radius": 1, "control_limit": 1, **defaults},
        "vehicles": [
            {"name": name, "start": [0, y], "goal": {"center": [9, y]}}
            for name, y in (("a", 0), ("b", 5))
        ],
    }


def test_a_current_moves_positions_and_no_velocity() -> None:
    scenario = decode_scenario(_two(drift={"velocity": [0.3, -0.1]}))
    assert scenario.vehicles[0].drift is not None
    assert scenario.vehicles[0].drift.tolist() == [0.15, -0.05, 0.0, 0.0]
    assert encode_scenario(scenario)["defaults"]["drift"] == {"velocity": [0.3, -0.1]}
    data = _two(drift={"state": [0.1, 0, 0, 0.2]})
    assert encode_scenario(decode_scenario(data))["defaults"]["drift"] == {
        "state": [0.1, 0.0, 0.0, 0.2]
    }


def test_a_time_constant_is_a_correlation_from_step_to_step() -> None:
    scenario = decode_scenario(_two(disturbance={"covariance": 0.1, "time_constant": 2.0}))
    a = scenario.vehicles[0]
    assert a.disturbance_correlation == pytest.approx(np.exp(-0.25))
    assert a.disturbance_covariance.tolist() == (0.1 * np.eye(4)).tolist()
    written = encode_scenario(scenario)["defaults"]["disturbance"]
    assert written == {"covariance": [0.1] * 4, "time_constant": 2.0}


def test_a_sensor_of_states_is_written_as_their_indices_and_any_other_as_its_matrix() -> None:
    for given in (
        {"of": [1, 0], "covariance": [0.1, 0.2]},
        {"matrix": [[1.0, 0.0, 0.5, 0.0]], "covariance": [0.3]},
    ):
        scenario = decode_scenario(_two(measurement=given))
        assert encode_scenario(scenario)["defaults"]["measurement"] == given
    sensor = decode_scenario(_two(measurement={"of": [1], "covariance": 4})).vehicles[1].measurement
    assert sensor is not None
    assert sensor.matrix.tolist() == [[0.0, 1.0, 0.0, 0.0]]
    assert sensor.covariance.tolist() == [[4.0]]


@pytest.mark.parametrize(
    ("default", "own"),
    [
        ({"disturbance": {"covariance": 0.1, "correlation": 0.5}}, {"disturbance_covariance": 0.2}),
        ({"disturbance_covariance": 0.2}, {"disturbance": {"covariance": 0.1, "correlation": 0.5}}),
    ],
)
def test_an_own_disturbance_replaces_the_default_however_either_is_described(
    default: dict[str, object], own: dict[str, object]
) -> None:
    data = _two(**default)
    data["vehicles"][1].update(own)
    a, b = decode_scenario(data).vehicles
    found = {v.disturbance_correlation: v.disturbance_covariance[0, 0] for v in (a, b)}
    assert found == {0.5: 0.1, 0.0: 0.2}
    assert (a.disturbance_correlation == 0.5) == ("disturbance" in default)
    assert b.radius == 1.0
