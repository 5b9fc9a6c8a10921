"""Scenes, and what a check warns of in them: looked at once for all tests of a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from radmpc import Scenario, load_scenario
from radmpc.preflight.concerns import Concern, concerns_of
from radmpc.preflight.outlook import Outlook, outlook_of

SCENES = Path(__file__).parent.parent / "data" / "scenes"


def of_scene(name: str) -> Scenario:
    return load_scenario(SCENES / f"{name}.yaml")


def warned(scenario: Scenario, kind: str) -> list[Concern]:
    """What of a kind a check warns of."""
    return [one for one in concerns_of(outlook_of(scenario)) if one.kind == kind]


@cache
def check_of(name: str) -> tuple[Outlook, tuple[Concern, ...]]:
    """The outlook of a scene, and what a check warns of."""
    outlook = outlook_of(of_scene(name))
    return outlook, tuple(concerns_of(outlook))


def warned_in(name: str, kind: str) -> list[Concern]:
    """What of a kind a check of a scene warns of."""
    return [one for one in check_of(name)[1] if one.kind == kind]
