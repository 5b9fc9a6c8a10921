from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from radmpc.console.commands.identifying import parse_columns
from radmpc.errors import ScenarioError
from radmpc.importing.logs.block import KEYS, reordered
from radmpc.io.native.scenario_file import decode_scenario, load_scenario
from radmpc.io.text.document import read_document
from simulator import Truth, as_csv, fly

from .conftest import CROSSING, Run, assert_one_line

SCENARIO = CROSSING.replace("dt: 1.0", "dt: 0.5")


def log(folder: Path, truth: Truth | None = None, kind: str = "commands", seed: int = 1) -> Path:
    """A log of a simulated flight."""
    path = folder / "wind.csv"
    path.write_text(as_csv(fly(truth or Truth(), seed, kind)), encoding="utf-8")
    return path


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "fleet.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


def test_a_table_tells_values_intervals_and_what_is_not_known(run: Run, tmp_path: Path) -> None:
    log(tmp_path, Truth(drift=(0.05, 0.0, 0.0, 0.0), vehicles=2))
    result = run("identify", "wind.csv")
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[0] == "wind.csv: 2 vehicles, 1200 steps of 0.5 s, double integrator in 2-D"
    for words in (
        "controls are the logged commands",
        "about 1199 independent steps",
        "do not differ beyond chance",
        "Gaussian: nothing speaks against it (Anderson-Darling p = ",
        "no more alike than by chance",
        "disturbance of vy, std. dev.",
        "drift of x ",
        "not told: feedback: commands without references hide what they answer",
    ):
        assert words in result.stdout, words


@pytest.mark.parametrize(
    ("truth", "kind"),
    [
        (Truth(), "commands"),
        (Truth(), "references"),
        (Truth(), "states"),
        (Truth(color=0.7, drift=(0.05, 0.0, 0.0, 0.0)), "commands"),
        (Truth(vehicles=2, share=0.5), "both"),
        (Truth(seen=(0.05, 0.05, 0.01, 0.01)), "commands"),
    ],
)
def test_a_scenario_takes_the_block_as_it_is(
    run: Run, tmp_path: Path, truth: Truth, kind: str
) -> None:
    log(tmp_path, truth, kind)
    assert run("identify", "wind.csv", "-o", "noise.yaml").exit_code == 0
    block = read_document("noise.yaml").value
    beside = {"covariance_samples"} | ({"shared_disturbances"} if truth.share else set())
    assert set(block) == {"defaults"} | beside
    path = tmp_path / "fleet.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    content = read_document(path).value
    kept = {k: v for k, v in content["defaults"].items() if not k.startswith("disturbance")}
    content = content | block | {"defaults": kept | block["defaults"]}
    vehicle = decode_scenario(content).vehicles[0]
    total = vehicle.disturbance_covariance + sum(
        part.matrix @ part.covariance @ part.matrix.T for part in vehicle.shared
    )
    # No color makes more of noise than white noise with this covariance does.
    assert np.trace(total) > 0.8 * np.trace(truth.spread)
    assert (vehicle.gain is not None) == (kind in {"references", "both"})
    text = (tmp_path / "noise.yaml").read_text(encoding="utf-8")
    assert "# logs: wind.csv" in text
    assert "# by: radmpc" in text


def test_what_vehicles_share_stands_beside_what_each_has_alone(run: Run, tmp_path: Path) -> None:
    log(tmp_path, Truth(color=0.7, drift=(0.05, 0.0, 0.0, 0.0), vehicles=2, share=0.5))
    run("identify", "wind.csv", "-o", "noise.yaml")
    block = read_document("noise.yaml").value
    assert {"disturbance", "drift"} <= set(block["defaults"])
    assert all(KEYS[key] for key in block["defaults"])
    [shared] = block["shared_disturbances"]
    assert shared["time_constant"] == block["defaults"]["disturbance"]["time_constant"]
    own = np.trace(block["defaults"]["disturbance"]["covariance"])
    assert np.trace(shared["covariance"]) == pytest.approx(own, rel=0.5)


def test_a_scenario_gets_what_its_vehicles_share_in_the_order_of_their_states(
    run: Run, tmp_path: Path, scenario: Path
) -> None:
    text = SCENARIO.replace(
        "  radius: 0.4",
        "  radius: 0.4\n  dynamics:\n    A: [[1, 0, 0, 0], [0.5, 1, 0, 0], [0, 0, 1, 0], "
        "[0, 0, 0.5, 1]]\n    B: [[0.5, 0], [0.125, 0], [0, 0.5], [0, 0.125]]\n"
        "    position: [1, 3]\n    velocity: [0, 2]",
    )
    text = text.replace("start: [1, 5]", "start: [0, 1, 0, 5]")
    scenario.write_text(text.replace("start: [9, 5.2]", "start: [0, 9, 0, 5.2]"), encoding="utf-8")
    log(tmp_path, Truth(vehicles=2, share=0.5))
    result = run("identify", "wind.csv", "--scenario", scenario, "-o", "new.yaml")
    assert result.exit_code == 0, result.output
    for vehicle in load_scenario(tmp_path / "new.yaml").vehicles:
        (part,) = vehicle.shared
        assert part.matrix[[1, 3, 0, 2]].tolist() == np.eye(4).tolist()


def test_vehicles_that_differ_are_written_by_name(run: Run, tmp_path: Path) -> None:
    calm, wild = as_csv(fly(Truth(), 1)), as_csv(fly(Truth(scale=3.0), 2))
    rows = wild.replace(",v1,", ",wild,").split("\n", 1)[1]
    (tmp_path / "wind.csv").write_text(calm + rows, encoding="utf-8")
    assert run("identify", "wind.csv", "-o", "noise.yaml").exit_code == 0
    vehicles = read_document("noise.yaml").value["vehicles"]
    assert [vehicle["name"] for vehicle in vehicles] == ["v1", "wild"]
    first, second = (np.trace(vehicle["disturbance_covariance"]) for vehicle in vehicles)
    assert second > 2.0 * first


def test_a_scenario_gets_noise_feedback_and_where_they_come_from(
    run: Run, tmp_path: Path, scenario: Path
) -> None:
    log(tmp_path, kind="both")
    result = run("identify", "wind.csv", "--scenario", scenario, "-o", "new.yaml")
    assert result.exit_code == 0, result.output
    assert "scenario written to new.yaml" in result.stdout
    old, new = load_scenario(scenario), load_scenario(tmp_path / "new.yaml")
    for before, after in zip(old.vehicles, new.vehicles, strict=True):
        assert after.disturbance_covariance == pytest.approx(Truth().spread, abs=0.004)
        assert after.gain == pytest.approx(Truth().gain, abs=1e-4)
        assert after.goal.lower.tolist() == before.goal.lower.tolist()
    source = new.source["noise"]
    assert source["logs"] == ["wind.csv"]
    assert source["steps"] == 600
    assert new.covariance_samples == source["independent_steps"]
    assert source["dt"] == 0.5
    assert run("check", "new.yaml").exit_code == 0


def test_states_in_another_order_get_their_noise(run: Run, tmp_path: Path, scenario: Path) -> None:
    text = SCENARIO.replace(
        "  radius: 0.4",
        "  radius: 0.4\n  dynamics:\n    A: [[1, 0, 0, 0], [0.5, 1, 0, 0], [0, 0, 1, 0], "
        "[0, 0, 0.5, 1]]\n    B: [[0.5, 0], [0.125, 0], [0, 0.5], [0, 0.125]]\n"
        "    position: [1, 3]\n    velocity: [0, 2]",
    )
    text = text.replace("start: [1, 5]", "start: [0, 1, 0, 5]")
    text = text.replace("start: [9, 5.2]", "start: [0, 9, 0, 5.2]")
    scenario.write_text(text, encoding="utf-8")
    log(tmp_path)
    result = run("identify", "wind.csv", "--scenario", scenario, "-o", "new.yaml")
    assert result.exit_code == 0, result.output
    covariance = load_scenario(tmp_path / "new.yaml").vehicles[0].disturbance_covariance
    order = [1, 3, 0, 2]
    assert covariance[np.ix_(order, order)] == pytest.approx(Truth().spread, abs=0.004)


def test_json_is_one_object_with_nothing_beside(run: Run, tmp_path: Path) -> None:
    log(tmp_path, Truth(vehicles=2, share=0.5, freedom=5.0), "both")
    result = run("identify", "wind.csv", "--json", "-o", "noise.yaml", "--plot", "r.png")
    content = json.loads(result.stdout)
    assert content["evidence"] == "commands"
    assert content["shared"]["is_sure"]
    [group] = content["groups"]
    assert group["vehicles"] == ["v1", "v2"]
    assert group["covariance"]["low"][0][0] < 0.012 < group["covariance"]["high"][0][0]
    assert not group["gaussian"]
    assert content["block"]["defaults"]["feedback"]["gain"][0][0] == pytest.approx(-0.3, abs=1e-4)
    assert (tmp_path / "r.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("nowhere.csv",), "nowhere.csv: No such file or directory"),
        (("wind.csv", "--dt", "0"), "--dt must be > 0 s, got 0"),
        (("wind.csv", "--dt", "0.1"), "--dt must be at least 0.5"),
        (("wind.csv", "--columns", "time"), "--columns must be like time=t,x=east"),
        (("wind.csv", "--columns", "x=a,x=b"), "--columns must be like time=t,x=east"),
        (("wind.csv", "--columns", "size=a"), "--columns must name some of time, vehicle"),
        (
            ("wind.csv", "--columns", "x=east,y=y"),
            "wind.csv: has no column 'east' for x: use --columns y=y,x=NAME; there are time, vehi",
        ),
        (("wind.csv", "-o", "noise.txt"), "noise.txt: noise is written as .yaml"),
        (("wind.csv", "-o", "no/noise.yaml"), "cannot write no/noise.yaml"),
        (("wind.csv", "--plot", "r.txt"), "r.txt: a figure must end in .png, .pdf, .svg"),
        (("wind.csv", "--plot", "noise.yaml", "-o", "noise.yaml"), "a figure must end in"),
        (("wind.csv", "--scenario", "fleet.yaml"), "--scenario needs -o"),
        (("wind.csv", "--scenario", "fleet.yaml", "-o", "fleet.yaml"), "it is what is read"),
        (
            ("wind.csv", "--scenario", "fleet.yaml", "-o", "n.yaml", "--dt", "1"),
            "--dt is 1 s, and the scenario's is 0.5 s",
        ),
        (("wind.csv", "wind.csv"), "wind.csv: is named twice, and would count twice"),
        (("wind.csv", "--plot", "wind.csv"), "a figure must end in"),
        ((), "Missing argument 'LOG'"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    run: Run, tmp_path: Path, scenario: Path, words: tuple[str, ...], message: str
) -> None:
    log(tmp_path, Truth(steps=60))
    result = run("identify", *words)
    assert result.exit_code == 2, result.output
    assert message in assert_one_line(result.stderr)
    assert "Traceback" not in result.stderr


def test_noise_of_another_model_is_refused(run: Run, tmp_path: Path, scenario: Path) -> None:
    text = SCENARIO.replace(
        "  radius: 0.4",
        "  radius: 0.4\n  dynamics: {A: [[1, 0], [0, 1]], B: [[0.5, 0], [0, 0.5]], "
        "position: [0, 1]}",
    ).replace(", speed: 0.05", "")
    text = text.replace("[0.001, 0.001, 0.0001, 0.0001]", "[0.001, 0.001]")
    scenario.write_text(text.replace("  speed_limit: 3.0\n", ""), encoding="utf-8")
    log(tmp_path)
    result = run("identify", "wind.csv", "--scenario", scenario, "-o", "new.yaml")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert "vehicles[0].dynamics: must be those of a double integrator" in line


def test_columns_are_parsed_as_they_are_typed() -> None:
    assert parse_columns(None) == {}
    assert parse_columns("time=t, x = east") == {"time": "t", "x": "east"}
    with pytest.raises(ScenarioError):
        parse_columns("time=")


def test_every_key_that_is_called_known_is_taken_by_scenarios() -> None:
    values = {
        "dynamics": {"A": [[1, 0], [0, 1]], "B": [[1, 0], [0, 1]], "position": [0, 1]},
        "feedback": {"gain": [[-0.1, 0], [0, -0.1]]},
        "disturbance_covariance": [0.1, 0.1],
        "disturbance": {"covariance": [0.1, 0.1], "time_constant": 2.0},
        "drift": {"velocity": [0.1, 0.0]},
        "measurement": {"of": [0, 1], "covariance": [0.1, 0.1]},
        "covariance_samples": 100,
        "shared_disturbances": [{"name": "wind", "covariance": [0.1, 0.1],
                                 "on": {"default": [[1, 0], [0, 1]]}}],
    }  # fmt: skip
    assert set(values) == set(KEYS)
    fields = {key: value for key, value in values.items() if KEYS[key]}
    beside = {"shared_disturbances", "covariance_samples"}
    top = {key: fields.pop(key) for key in beside & set(fields)}
    if "disturbance" in fields:
        del fields["disturbance_covariance"]
    vehicle = {"name": "a", "start": [0, 0], "goal": {"center": [1, 1]}, "radius": 0.1,
               "control_limit": 1.0, **fields}  # fmt: skip
    head = {"format": "radmpc/scenario/1", "name": "n", "dt": 1.0, "horizon": 5, "risk_bound": 0.1}
    assert decode_scenario({**head, "vehicles": [vehicle], **top}).vehicles[0].name == "a"


def test_every_field_follows_the_order_of_the_state() -> None:
    rows = np.arange(16.0).reshape(4, 4)
    fields = {
        "disturbance_covariance": rows.tolist(),
        "disturbance": {"covariance": rows.tolist(), "time_constant": 2.0},
        "feedback": {"gain": rows[:2].tolist()},
        "drift": {"state": [1.0, 2.0, 3.0, 4.0]},
        "measurement": {"of": [0, 3], "covariance": [1.0, 2.0]},
        "covariance_samples": 7,
    }
    # Positions stand second and fourth, velocities first and third.
    found = reordered(fields, [1, 3, 0, 2])
    turned = np.array(found["disturbance_covariance"])
    assert turned[1, 1] == rows[0, 0]
    assert turned[3, 0] == rows[1, 2]
    assert found["disturbance"] == {"covariance": turned.tolist(), "time_constant": 2.0}
    assert np.array(found["feedback"]["gain"])[:, [1, 3, 0, 2]].tolist() == rows[:2].tolist()
    assert found["drift"] == {"state": [3.0, 1.0, 4.0, 2.0]}
    assert found["measurement"] == {"of": [1, 2], "covariance": [1.0, 2.0]}
    assert found["covariance_samples"] == 7
    assert reordered(fields, [0, 1, 2, 3]) == fields
