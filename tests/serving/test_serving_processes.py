"""The whole server: processes that search, die, pause, and end with it."""

from __future__ import annotations

import asyncio
import errno
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from importlib.resources import files
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest
from served import PATIENCE, CallFailedError, Page, Site
from test_serving_jobs import two
from websockets.sync.client import connect

from radmpc.io.text.json_text import write_json
from radmpc.serving.failures import CallError
from radmpc.serving.processes.worker import Worker

HARBOR = files("radmpc.data").joinpath("harbor.yaml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """Serve a document that takes a while to plan, with workers."""
    folder = tmp_path_factory.mktemp("folder")
    (folder / "two.json").write_text(write_json(two()), encoding="utf-8")
    with Site(folder) as site:
        yield site


@contextmanager
def started(command, folder):
    """Start a command that is gone in the end, whatever it was told: nobody waits for it."""
    with subprocess.Popen(
        command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def is_there(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").split()[2] != "Z"


def gone(pids):
    """Whether all processes end soon."""
    for _ in range(200):
        if not any(is_there(pid) for pid in pids):
            return True
        time.sleep(0.05)
    return False


def begin(page, document, planner="certified", seconds=60.0):
    return page.call(
        "plan", document=document, planner=planner, seconds=seconds, gap=1e-9, riskBound=None
    )


def running(page):
    """Wait until a search has told something."""
    page.event(
        "search",
        lambda message: (
            message["state"]["stage"] != "starting" and message["state"]["state"] == "running"
        ),
    )


def ended(page, search):
    return page.event(
        "search",
        lambda message: (
            message["state"]["search"] == search
            and message["state"]["state"] in {"ended", "failed"}
        ),
    )["state"]


@pytest.mark.slow
def test_a_search_streams_plans_is_held_goes_on_and_outlives_its_page(served):
    page = served.page()
    document = page.call("open", path="two.json")["document"]
    search = begin(page, document)["search"]
    first = page.event("plan")["summary"]
    assert first["holds"]
    assert page.call("pause", search=search)["state"] == "paused"
    page.socket.close()
    again = served.page()
    begun = time.monotonic()
    state = again.call("state", document=again.call("hello")["document"])
    assert state["plans"][0]["plan"] == first["plan"]
    held = state["searches"][-1]
    assert held["state"] == "paused"
    time.sleep(0.5)
    resumed = again.call("resume", search=search)
    # Time that it was held does not count; what passes between two answers does, in hundredths.
    others = time.monotonic() - begun - 0.5
    assert 0.0 <= resumed["seconds"] - held["seconds"] <= others + 0.011
    again.call("stop", search=search)
    told = ended(again, search)
    assert told["state"] == "ended"
    assert "plan found" in told["note"]
    plans = again.call("state", document=document)["plans"]
    assert plans[-1]["cost"] <= first["cost"]
    view = again.call("view", plan=plans[-1]["plan"])
    assert [track["name"] for track in view["tracks"]] == ["a", "b"]


@pytest.mark.slow
def test_a_worker_that_is_killed_is_an_answer_and_the_next_one_plans(served):
    page = served.page()
    document = page.call("open", path="two.json")["document"]
    search = begin(page, document)["search"]
    running(page)
    # Others may be at what the page asked for besides.
    for worker in tuple(served.desk.crew._busy):
        os.kill(worker.pid, signal.SIGKILL)
    told = ended(page, search)
    assert told["state"] == "failed"
    assert "died" in told["note"]
    with pytest.raises(CallFailedError, match="planner must be one of"):
        begin(page, document, "magic")
    again = begin(page, document)["search"]
    running(page)
    page.call("stop", search=again)
    assert ended(page, again)["state"] == "ended"


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_the_command_prints_its_address_and_takes_its_workers_along(tmp_path, number):
    (tmp_path / "harbor.yaml").write_text(HARBOR, encoding="utf-8")
    command = [sys.executable, "-m", "radmpc", "serve", "harbor.yaml", "--no-open"]
    with started(command, tmp_path) as server:
        line = server.stdout.readline().strip()
        assert line.startswith("http://127.0.0.1:")
        base, token = line.split("/#token=")
        address = f"{base.replace('http', 'ws')}/socket?token={token}"
        with connect(address, max_size=None, max_queue=1 << 20) as socket:
            page = Page(socket)
            document = page.call("hello")["document"]
            search = begin(page, document)["search"]
            running(page)
            page.call("pause", search=search)  # who stands still goes, too
            children = Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text("utf-8")
            server.send_signal(number)
            out, err = server.communicate(timeout=PATIENCE)
        if number == signal.SIGINT:
            assert server.returncode == 0
            assert out + err == ""
        assert gone([int(pid) for pid in children.split()])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["missing.yaml"], "missing.yaml: there is no such file"),
        (["--folder", "nowhere"], "nowhere: there is no such folder"),
        (["../two.json", "--folder", "."], "is not in the folder"),
        (["broken.json"], "broken.json"),
    ],
)
def test_what_cannot_be_served_is_one_line(tmp_path, words, said, monkeypatch, capsys):
    from radmpc.cli import app  # noqa: PLC0415 - in the folder

    inside = tmp_path / "in"
    inside.mkdir()
    (tmp_path / "two.json").write_text("{}", encoding="utf-8")
    (inside / "broken.json").write_text("{", encoding="utf-8")
    monkeypatch.chdir(inside)
    code = app(["serve", *words], standalone_mode=False)
    line = capsys.readouterr().err
    assert code == 2
    assert said in line
    assert line.count("\n") == 1


def test_a_port_that_is_taken_or_a_missing_extra_is_one_line(tmp_path, monkeypatch, capsys):
    from radmpc.cli import app  # noqa: PLC0415 - see above
    from radmpc.serving.starting import listening  # noqa: PLC0415 - see above

    monkeypatch.chdir(tmp_path)
    with listening(0) as port:
        number = port.getsockname()[1]
        assert app(["serve", "--port", str(number)], standalone_mode=False) == 2
    assert capsys.readouterr().err == f"radmpc: port {number}: {os.strerror(errno.EADDRINUSE)}\n"
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert app(["serve"], standalone_mode=False) == 2
    said = capsys.readouterr().err
    assert "pip install 'radmpc[serve]'" in said
    assert said.count("\n") == 1


@pytest.mark.slow
def test_ctrl_c_while_a_worker_starts_is_answered_and_does_not_reach_it(monkeypatch):
    right, heard = SpawnProcess.start, []

    def start(process):
        os.kill(os.getpid(), signal.SIGINT)
        right(process)

    async def use_worker():
        asyncio.get_running_loop().add_signal_handler(signal.SIGINT, heard.append, "ctrl-c")
        worker = Worker()
        os.kill(worker.pid, signal.SIGINT)
        try:
            with pytest.raises(CallError, match="not a scenario"):
                await worker.run("concerns", "not a scenario")
        finally:
            worker.kill()
            worker.bury()

    monkeypatch.setattr(SpawnProcess, "start", start)
    asyncio.run(use_worker())
    assert heard == ["ctrl-c"]


def test_ctrl_c_while_the_file_is_being_opened_ends_without_a_word(tmp_path):
    (tmp_path / "harbor.yaml").write_text(HARBOR, encoding="utf-8")
    command = [sys.executable, "-m", "radmpc", "serve", "harbor.yaml"]
    with started(command, tmp_path) as server:
        assert server.stdout.readline().startswith("http://127.0.0.1:")
        server.send_signal(signal.SIGINT)
        out, err = server.communicate(timeout=PATIENCE)
    assert (server.returncode, out, err) == (0, "", "")


@pytest.mark.nightly
def test_plans_and_flights_are_kept_and_opened_again(served):
    page = served.page()
    document = page.call("open", path="two.json")["document"]
    search = begin(page, document, "distance", 20.0)["search"]
    assert ended(page, search)["state"] == "ended"
    plan = page.call("state", document=document)["plans"][-1]["plan"]
    trails = page.call("simulate", plan=plan, flights=50, seed=1)
    assert trails["flights"] == 50
    assert page.call("export", plan=plan, format="csv")["name"].endswith(".csv")
    assert page.call("savePlan", plan=plan, path="two.plan.json", overwrite=False) is None
    opened = page.call("open", path="two.plan.json")
    assert opened["file"] is None
    (kept,) = opened["plans"]
    assert kept["cost"] == pytest.approx(page.call("view", plan=plan)["summary"]["cost"])
    options = {"replan": "none", "log": "two.jsonl"}
    flight = page.call("fly", plan=plan, seed=2, pace=0.0, options=options)["flight"]
    done = page.event("flight", lambda message: message["state"]["state"] != "running")["state"]
    assert done["flight"] == flight
    assert done["note"].startswith("flown to its end")
    assert [tick["step"] for tick in done["ticks"]] == list(range(9))
    again = page.call("open", path="two.jsonl")["flights"][0]
    assert again["state"] == "ended"
    assert again["ticks"] == done["ticks"]
    kinds = {entry["path"]: entry["kind"] for entry in page.call("files")}
    assert kinds["two.plan.json"] == "plan"
    assert kinds["two.jsonl"] == "flight"
    with pytest.raises(CallFailedError, match="not flown from a page"):
        page.call("fly", plan=plan, seed=2, pace=0.0, options={"with": "mavlink"})
