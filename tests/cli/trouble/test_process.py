from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from cli.conftest import assert_one_line

# Plans as usual, but says when it has begun and first waits to be interrupted.
PATIENT = """
import sys, time
from radmpc.console.commands import plan_command as planning
real = planning.plan
def patient(scenario, planner, *, stop, **rest):
    print("begun", file=sys.stderr, flush=True)
    while not stop():
        time.sleep(0.01)
    if "forever" in sys.argv:
        print("asked", file=sys.stderr, flush=True)
        time.sleep(60)
    return real(scenario, planner, stop=stop if "at-once" in sys.argv else None, **rest)
planning.plan = patient
from radmpc.cli import app
app(sys.argv[2:])
"""


def radmpc(*words: object) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own."""
    command = [sys.executable, "-m", "radmpc", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def begin(mode: str, *words: object) -> subprocess.Popen[str]:
    """Start planning in a process and wait until it is at it."""
    process = subprocess.Popen(
        [sys.executable, "-c", PATIENT, mode, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "begun\n"
    return process


def test_the_module_runs_as_a_command(crossing: Path) -> None:
    result = radmpc("check", crossing)
    assert result.returncode == 0
    assert result.stdout.startswith("valid: crossing")


@pytest.mark.slow
def test_failures_leave_no_traceback(tmp_path: Path) -> None:
    result = radmpc("plan", tmp_path / "none.yaml")
    assert result.returncode == 2
    assert_one_line(result.stderr)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device here")
def test_a_full_stdout_is_one_line(crossing: Path) -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        result = subprocess.run(
            [sys.executable, "-m", "radmpc", "check", str(crossing)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert result.returncode == 2
    expected = "radmpc: cannot write stdout: No space left on device"
    assert assert_one_line(result.stderr) == expected


@pytest.mark.sampled(2)
@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
@pytest.mark.skipif(sys.platform == "win32", reason="no such shell here")
def test_a_closed_stream_changes_no_exit_code(closed: str, crossing: Path) -> None:
    for words, code in ((f"check {crossing}", 0), ("nothing", 2)):
        command = f"{sys.executable} -m radmpc {words} {closed}"
        result = subprocess.run(
            ["sh", "-c", command], capture_output=True, text=True, timeout=60, check=False
        )
        assert result.returncode == code, result.stderr
        assert "Traceback" not in result.stderr
        # A line for a closed stderr does not go to stdout instead.
        assert "radmpc:" not in result.stdout


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_letters_that_stdout_lacks_are_escaped(encoding: str, crossing: Path) -> None:
    text = crossing.read_text(encoding="utf-8").replace("east", "öst→")
    crossing.write_text(text, encoding="utf-8")
    results = [
        subprocess.run(
            [sys.executable, "-m", "radmpc", "check", str(crossing), *words],
            capture_output=True,
            timeout=60,
            check=False,
            env=os.environ | {"PYTHONIOENCODING": encoding},
        )
        for words in ([], ["--json"])
    ]
    assert [result.returncode for result in results] == [0, 0], results
    report, content = (result.stdout.decode(encoding) for result in results)
    assert "st\\u2192" in report
    # JSON is in UTF-8 or, as here, in that part of it that every encoding shares.
    assert content.isascii()
    assert json.loads(content)["vehicles"][0]["name"] == "öst→"


@pytest.mark.slow
def test_one_interrupt_returns_the_plan_so_far(crossing: Path) -> None:
    process = begin("finish", "plan", crossing, "-o", crossing.with_name("a.json"))
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "plan written to" in out
    assert "Ctrl-C again stops at once" in assert_one_line(err)
    assert crossing.with_name("a.json").exists()


@pytest.mark.slow
def test_an_interrupt_before_any_plan_is_a_no(crossing: Path) -> None:
    process = begin("at-once", "plan", crossing)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert err.splitlines()[-1] == "radmpc: interrupted before any plan was found"
    assert "Traceback" not in err


@pytest.mark.slow
def test_two_interrupts_stop_at_once(crossing: Path) -> None:
    process = begin("forever", "plan", crossing)
    process.send_signal(signal.SIGINT)
    assert process.stderr is not None
    while process.stderr.readline() != "asked\n":
        pass
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 1
    assert err.splitlines()[-1] == "radmpc: interrupted"
    assert "Traceback" not in err


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_a_killed_process_leaves_no_half_plan(crossing: Path) -> None:
    target = crossing.with_name("a.json")
    process = begin("forever", "plan", crossing, "-o", target)
    process.kill()
    process.communicate(timeout=30)
    assert not target.exists()
