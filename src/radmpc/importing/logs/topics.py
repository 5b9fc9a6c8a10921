"""Whose a topic is, and whether it says where the vehicle is or where it is to be."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from radmpc.importing.logs.recording import interpolated
from radmpc.importing.logs.series import ODOMETRY, POSE, Series

__all__ = ["is_reference", "vehicles_of"]

_REFERENCE = frozenset({
    "ref", "refs", "reference", "references", "setpoint", "setpoints", "target", "targets",
    "desired", "goal", "goals", "cmd", "cmds", "command", "commands", "commanded",
})  # fmt: skip
"""Words in a topic's last parts that make it say where the vehicle is to be."""

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
"""A word of a topic: parts end at whatever is no letter, and where a capital begins another."""

_APART = 0.2
"""Share [-] of what two topics' places move that the way between them must vary by before they
are not of one vehicle: sensors of one differ by an offset and their noise."""

_MOST_TOLD = 6
"""Topics that a warning lists."""

Leaves = dict[tuple[str, str], Series]
"""Topics of one vehicle by the rest of their names, and types."""


def vehicles_of(
    path: Path, topics: Mapping[tuple[str, str], Series], warnings: list[str]
) -> dict[str, Leaves]:
    """Return the topics of every vehicle, by its name: empty where topics have no namespace.

    Parameters
    ----------
    path : Path
        The bag.
    topics : mapping
        By topic and type.
    warnings : list of str
        What had to be assumed is added.
    """
    spaces: dict[str, Leaves] = {}
    for (topic, kind), one in topics.items():
        space, leaf = _split(topic)
        spaces.setdefault(space, {})[leaf, kind] = one
    vehicles: dict[str, Leaves] = {}
    owners: dict[str, str] = {}
    for space, leaves in spaces.items():
        apart = _moving_apart(leaves)
        if not apart:
            vehicles[space] = leaves
            continue
        told = apart[:_MOST_TOLD] + [f"{len(apart) - _MOST_TOLD} more"] * (len(apart) > _MOST_TOLD)
        warnings.append(
            f"{path}: below {space}, {', '.join(told)} move apart: taken for vehicles of their own"
        )
        for (leaf, kind), one in leaves.items():
            inner, rest = _split(leaf)
            name = inner or space
            if name != space and (name in spaces or owners.setdefault(name, space) != space):
                name = f"{space}/{inner}"
            vehicles.setdefault(name, {})[rest, kind] = one
    return vehicles


def is_reference(leaf: str) -> bool:
    """Whether a topic says where a vehicle is to be.

    Parameters
    ----------
    leaf : str
        Its name behind the vehicle's.
    """
    return any(word.lower() in _REFERENCE for word in _WORD.findall(leaf))


def _split(topic: str) -> tuple[str, str]:
    """Return a topic's namespace and the rest."""
    space, _, leaf = topic.strip("/").partition("/")
    return (space, leaf) if leaf else ("", space)


def _moving_apart(leaves: Leaves) -> list[str]:
    """Return topics that differ in their first part alone, and whose places are not one vehicle's.

    Trackers put all that they track below a namespace of their own.
    """
    alike: dict[tuple[str, str], list[str]] = {}
    for leaf, kind in leaves:
        inner, rest = _split(leaf)
        if inner and kind in {ODOMETRY, POSE} and not is_reference(leaf):
            alike.setdefault((rest, kind), []).append(leaf)
    for (_, kind), names in alike.items():
        first, *others = (leaves[name, kind] for name in names)
        if any(_are_apart(first, other) for other in others):
            return names
    return []


def _are_apart(one: Series, other: Series) -> bool:
    """Whether two topics tell the places of different things."""
    there = interpolated(other.times, other.values, one.times)
    is_both = np.isfinite(there - one.values).all(axis=1)
    if is_both.sum() < 2:
        return False
    here, there = one.values[is_both], there[is_both]
    between, *moved = (
        float(np.sqrt(rows.var(axis=0).sum())) for rows in (there - here, here, there)
    )
    return between > _APART * max(moved)
