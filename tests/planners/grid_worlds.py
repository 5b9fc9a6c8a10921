"""Worlds of unit cells, as other programs write them."""

from __future__ import annotations

from pathlib import Path

from radmpc import import_scenario
from radmpc.model.scenario import Scenario


def cells(path: Path, size: tuple[int, int], free: set[tuple[int, int]], robots: list) -> Scenario:
    """Import a grid world of unit cells; robots are pairs of start and goal."""
    blocked = [[x, y] for x in range(size[0]) for y in range(size[1]) if (x, y) not in free]
    lines = ["agents:"]
    for number, (start, goal) in enumerate(robots):
        lines += [f"- name: r{number}", f"  start: {list(start)}", f"  goal: {list(goal)}"]
    lines += ["map:", f"  dimensions: {list(size)}", f"  obstacles: {blocked}"]
    file = path / "cells.yaml"
    file.write_text("\n".join(lines))
    return import_scenario(file).scenario
