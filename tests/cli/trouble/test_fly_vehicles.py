"""`radmpc fly` of what does not come to where it was: vehicles."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from cli.conftest import Run, assert_one_line
from radmpc.console.commands import flying
from radmpc.flying import backends
from radmpc.flying.backends import BackendKind


@pytest.mark.parametrize(
    ("when", "hint"),
    [
        ((1, 2), "1 of 2 missions are over; vehicles cannot go on in the middle of a mission"),
        ((0, 6), "1 of 2 missions are over; go on with 'radmpc fly a.jsonl'"),
    ],
)
def test_an_interrupted_flight_says_how_it_goes_on_only_if_it_can(
    run: Run,
    crossing: Path,
    crossing_plan: bytes,
    monkeypatch: pytest.MonkeyPatch,
    when: tuple[int, int],
    hint: str,
) -> None:
    path = crossing.with_name("crossing.plan.json")
    path.write_bytes(crossing_plan)
    kind = BackendKind("vehicles", "radmpc.flying.model:Model", None, "", repeats=False)
    monkeypatch.setattr(backends, "BACKENDS", {**backends.BACKENDS, "vehicles": kind})
    usual = flying._Progress.__call__

    def told(self: object, mission: int, step: int) -> None:
        usual(self, mission, step)  # type: ignore[arg-type] # it is one
        if (mission, step) == when:
            os.kill(os.getpid(), signal.SIGINT)

    words = ("fly", path, "--with", "vehicles", "--replan", "none", "--missions", 2)
    with monkeypatch.context() as patch:
        patch.setattr(flying._Progress, "__call__", told)
        result = run(*words, "-o", "a.jsonl")
    assert f"interrupted: {hint}" in result.stderr
    over = run(*words, "-o", "a.jsonl")
    assert over.exit_code == 2
    line = assert_one_line(over.stderr)
    assert ("go on with 'radmpc fly a.jsonl'" in line) == ("go on with" in hint)
    assert (run("fly", "a.jsonl").exit_code == 0) == ("go on with" in hint)
