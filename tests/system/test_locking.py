from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from radmpc.system.locking import try_lock

WITHOUT = """
import sys
sys.modules["fcntl"] = None
from radmpc.system.locking import try_lock
import radmpc.cli, radmpc.console.commands.verifying, radmpc.experiments.study.journal
import radmpc.console.commands.drawing, radmpc.console.commands.flying
import radmpc.console.commands.sweeping
with open(sys.argv[1], "ab") as file, open(sys.argv[1], "ab") as other:
    print(try_lock(file), try_lock(other))
"""
"""As on Windows, which has no such locks."""


def test_a_file_is_locked_until_it_is_closed(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    path = tmp_path / "file"
    with open(path, "ab") as first:
        assert try_lock(first)
        with open(path, "ab") as second:
            assert not try_lock(second)
    with open(path, "ab") as third:
        assert try_lock(third)


def test_a_system_without_locks_runs_commands_all_the_same(tmp_path: Path) -> None:
    result = subprocess.run(
        [sys.executable, "-c", WITHOUT, str(tmp_path / "file")],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.split() == ["True", "True"]
