"""Disturbances that vehicles share, in files."""

from __future__ import annotations

import math

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario

WIND = {"name": "wind", "covariance": [0.01, 0.02], "time_constant": 4.0}
GUST = [[0.5, 0.0], [0.0, 0.5], [1.0, 0.0], [0.0, 1.0]]


def content(*shared: object, names: tuple[str, ...] = ("a", "tug")) -> dict[str, object]:
    vehicles = [
        {"name": name, "start": [4.0 * i, 0.0], "goal": {"center": [4.0 * i, 1.0]}}
        for i, name in enumerate(names)
    ]
    return {
        "format": "radmpc/scenario/1",
        "name": "windy",
        "dt": 1.0,
        "horizon": 3,
        "risk_bound": 0.1,
        "defaults": {"radius": 0.3, "control_limit": 1.0},
        "vehicles": vehicles,
        "shared_disturbances": list(shared),
    }


def test_the_default_is_for_all_that_are_not_named():
    scenario = decode_scenario(
        content({**WIND, "on": {"default": GUST, "tug": np.eye(4, 2).tolist()}})
    )
    a, tug = scenario.vehicles
    assert a.shared[0].matrix.tolist() == GUST
    assert tug.shared[0].matrix.tolist() == np.eye(4, 2).tolist()
    assert a.shared[0].correlation == math.exp(-0.25)
    assert a.shared[0].covariance.tolist() == [[0.01, 0.0], [0.0, 0.02]]


def test_null_is_no_part_and_a_number_is_every_state():
    scenario = decode_scenario(
        content({"name": "swell", "covariance": 0.1, "on": {"default": 0.5, "tug": None}})
    )
    a, tug = scenario.vehicles
    assert a.shared[0].matrix.tolist() == (0.5 * np.eye(4)).tolist()
    assert tug.shared == ()


@pytest.mark.parametrize(
    "on",
    [
        {"default": GUST},
        {"a": GUST},
        {"default": GUST, "tug": None},
        {"a": GUST, "tug": np.eye(4, 2).tolist()},
        {"tug": GUST},
    ],
)
@pytest.mark.parametrize("names", [("a", "tug"), ("a", "tug", "default")])
def test_what_is_written_reads_back_equal(on, names):
    swell = {"name": "swell", "covariance": [[0.2]], "correlation": 0.3,
             "on": {"default": [[1.0], [0.0], [0.0], [0.0]]}}  # fmt: skip
    scenario = decode_scenario(content({**WIND, "on": on}, swell, names=names))
    again = decode_scenario(encode_scenario(scenario))
    for before, after in zip(scenario.vehicles, again.vehicles, strict=True):
        parts = [
            [(p.name, p.matrix.tolist(), p.covariance.tolist(), p.correlation) for p in v.shared]
            for v in (before, after)
        ]
        assert parts[0] == parts[1]


@pytest.mark.parametrize(
    ("entry", "path", "text"),
    [
        ({**WIND, "on": {"boat": GUST}}, ("on", "boat"), "must name vehicles, or be default"),
        ({**WIND, "on": {"default": GUST[:3]}}, ("on", "default"), "must have 4 rows"),
        ({**WIND, "time_constant": 0.0, "on": {"default": GUST}}, ("time_constant",), "> 0 s"),
        ({**WIND, "correlation": 0.5, "on": {"default": GUST}}, (), "only one of"),
        ({**WIND, "on": {}}, ("on",), "got nobody"),
        ({**WIND, "on": {"a": None}}, ("on",), "must name a vehicle that it acts on"),
        ({**WIND, "name": "", "on": {"default": GUST}}, ("name",), "must not be empty, got ''"),
        ({**WIND, "name": " ", "on": {"default": GUST}}, ("name",), "must not be blank, got ' '"),
        ({**WIND, "covariance": [1.0, -1.0], "on": {"default": GUST}}, ("covariance",), "semi-def"),
    ],
)
def test_what_is_wrong_is_said_where_it_stands(entry, path, text):
    with pytest.raises(ScenarioError, match=text) as caught:
        decode_scenario(content(entry))
    assert caught.value.path == ("shared_disturbances", 0, *path)


def test_a_source_stands_there_once():
    entry = {**WIND, "on": {"default": GUST}}
    with pytest.raises(ScenarioError, match="twice"):
        decode_scenario(content(entry, entry))
