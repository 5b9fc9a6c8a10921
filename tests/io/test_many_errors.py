"""All that is wrong with a file is told in one go, a line each."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.experiments.families import circle
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.io.native.scenario_file import load_scenario, save_scenario

BROKEN = Path(__file__).parent.parent / "data" / "broken"


def lines_of(path: Path) -> list[str]:
    """What is wrong with a file, without its folder."""
    with pytest.raises(FileFormatError) as caught:
        load_scenario(path)
    lines = [str(caught.value), *getattr(caught.value, "__notes__", ())]
    return [line.removeprefix(f"{path.parent}/") for line in lines]


def edited(folder: Path, count: int, **changes: Any) -> Path:
    """A scenario of vehicles with the fields of some changed, and fields of its own."""
    data: Any = to_dict(circle(count))
    vehicles = changes.pop("vehicles", {})
    for i, change in vehicles.items():
        data["vehicles"][i] |= change
    path = folder / "fleet.json"
    path.write_text(json.dumps(data | changes, indent=0), encoding="utf-8")
    return path


def test_every_wrong_number_has_its_line(tmp_path: Path) -> None:
    path = edited(
        tmp_path,
        4,
        dt=-1.0,
        horizon=0,
        risk_bound=0.7,
        vehicles={1: {"radius": -2.0, "cost_weight": -1.0}, 3: {"control_limit": -3.0}},
    )
    told = [line.partition(": ")[2] for line in lines_of(path)]
    assert told == [
        "dt: must be > 0 s, got -1.0",
        "vehicles[1].radius: must be > 0 m, got -2.0",
        "vehicles[1].cost_weight: must be >= 0, got -1.0",
        "vehicles[3].control_limit: must be > 0 per axis, got [-3.0, -3.0]",
        "horizon: must be at least 1 step, got 0",
        "risk_bound: must lie between 0 and 0.5, both excluded, got 0.7",
    ]
    text = path.read_text(encoding="utf-8").splitlines()
    for line in lines_of(path):
        number, field = line.split(":")[1:3]
        assert f'"{field.strip().split(".")[-1]}"' in text[int(number) - 1]


def test_of_many_errors_ten_are_told_and_the_others_counted(tmp_path: Path) -> None:
    path = edited(tmp_path, 14, vehicles={i: {"radius": -1.0} for i in range(14)})
    lines = lines_of(path)
    assert len(lines) == 11
    assert "vehicles[9].radius" in lines[9]
    assert lines[10] == "fleet.json: 4 more like these"


def test_wrong_kinds_are_all_told_after_the_line_that_counts_them() -> None:
    assert lines_of(BROKEN / "several_errors.yaml") == [
        "several_errors.yaml:3: dt: must be a number, got 'one' (and 2 more)",
        "several_errors.yaml:4: horizon: must be a whole number, got 'many'",
        "several_errors.yaml:11: defaults.radius: must be a number, got [1]",
    ]


def test_what_is_wrong_in_the_defaults_is_told_once(tmp_path: Path) -> None:
    data: Any = to_dict(circle(3))
    assert "radius" in data["defaults"]
    path = edited(tmp_path, 3, defaults=data["defaults"] | {"radius": -1.0})
    (line,) = lines_of(path)
    assert line.endswith("defaults.radius: must be > 0 m, got -1.0")


def test_plain_data_tell_all_errors_too() -> None:
    data: Any = to_dict(circle(3))
    with pytest.raises(ScenarioError) as caught:
        from_dict(data | {"horizon": 0, "risk_bound": 1.0})
    assert [error.path for error in (caught.value, *caught.value.more)] == [
        ("horizon",),
        ("risk_bound",),
    ]


@pytest.mark.slow
def test_a_long_list_in_brackets_is_not_read_to_its_end(tmp_path: Path) -> None:
    entries = ",\n".join(["{name: a}"] * 10_001)
    text = f"format: radmpc/scenario/1\nname: x\nvehicles: [{entries}, {{{{\n"
    (tmp_path / "large.yaml").write_text(text, encoding="utf-8")
    assert lines_of(tmp_path / "large.yaml") == [
        "large.yaml:3: must have at most 10,000 entries, got more"
    ]


def test_dashes_within_entries_are_not_counted(tmp_path: Path) -> None:
    path = tmp_path / "fleet.yaml"
    save_scenario(circle(2), path)
    text = path.read_text(encoding="utf-8")
    head, tail = text.split("vehicles:")
    reef = "\nobstacles:\n# a reef\n- name: reef\n  vertices:\n" + "".join(
        f"  - [{x}, {y}]\n" for x, y in ((50, 50), (51, 50), (50, 51))
    )
    note = "source:\n  log:\n" + "  - 1\n" * 10_001
    path.write_text(head.rstrip() + reef + "vehicles:" + tail.rstrip() + "\n" + note)
    assert len(load_scenario(path).vehicles) == 2


@pytest.mark.parametrize("suffix", [".json", ".yaml"])
def test_too_many_vehicles_are_counted_before_anything_else(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"large{suffix}"
    save_scenario(circle(2), path)
    text = path.read_text(encoding="utf-8")
    if suffix == ".json":
        data = json.loads(text)
        data["vehicles"] = [{"name": i} for i in range(100_000)]  # names that are no text
        text = json.dumps(data)
    else:
        text = text[: text.index("vehicles:")] + "vehicles:\n" + "- {name: 1}\n" * 100_000
    path.write_text(text, encoding="utf-8")
    (line,) = lines_of(path)
    assert line.endswith("vehicles: must have at most 10,000 entries, got 100,000")
