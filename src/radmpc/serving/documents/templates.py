"""Scenarios to begin with."""

from __future__ import annotations

from radmpc import data
from radmpc.data import TEMPLATES
from radmpc.serving.failures import refused
from radmpc.serving.protocol import Content, Named

__all__ = ["empty", "template", "templates"]


def templates() -> list[Named]:
    """Return what there is to begin with; the first comment of each says what it is."""
    return [{"name": kind, "text": _first_line(kind)} for kind in TEMPLATES]


def template(kind: str) -> str:
    """Return a template as its file has it.

    Raises
    ------
    CallError
        If there is none of that name.
    """
    if kind not in TEMPLATES:
        raise refused(f"template must be one of {', '.join(TEMPLATES)}")
    return data.template(kind)


def empty() -> Content:
    """Return a world of 40 by 30 m with nothing in it: drawing a vehicle makes it a scenario."""
    return {
        "format": "radmpc/scenario/1",
        "name": "untitled",
        "dt": 1.0,
        "horizon": 20,
        "risk_bound": 0.05,
        "workspace": {"min": [0.0, 0.0], "max": [40.0, 30.0]},
        "obstacles": [],
        "defaults": {
            "radius": 0.5,
            "control_limit": 1.0,
            "speed_limit": 2.5,
            "initial_covariance": [0.001, 0.001, 0.0001, 0.0001],
            "disturbance_covariance": [0.001, 0.001, 0.0001, 0.0001],
        },
        "vehicles": [],
    }


def _first_line(kind: str) -> str:
    """Return the first sentence of a template's comment."""
    line = template(kind).partition("\n")[0].lstrip("# ")
    return line.partition(". ")[0].rstrip(".") + "."
