"""Plans from files on their way past the referee: how far it is, given up, ended by somebody."""

from __future__ import annotations

import asyncio
import threading
from contextlib import asynccontextmanager
from types import SimpleNamespace

import pytest

from radmpc.experiments.families import paper
from radmpc.serving.desk import opening
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.judging import judged, limit_of, stop_judging
from radmpc.serving.failures import CallError
from radmpc.serving.folder import Folder
from radmpc.serving.processes.crew import Crew
from radmpc.serving.work import judging

PLAN = SimpleNamespace(scenario=paper(2, 1))


class Slow:
    """A worker that tells what it has spent, and judges when that is all."""

    def __init__(self, *spent):
        self.spent = spent

    async def run(self, job, plan, *, listener):
        for seconds in self.spent:
            await asyncio.sleep(0)
            listener("spent", seconds)
        await asyncio.sleep(0)
        if self.spent and self.spent[-1] == 1.0:
            await asyncio.Event().wait()
        return plan


@pytest.fixture
def on_desk(tmp_path, monkeypatch):
    """Judge by a worker, on a desk; return what came of it and what pages were told."""

    def judge(worker, act=lambda desk, event: None):
        @asynccontextmanager
        async def given(self):
            yield worker

        monkeypatch.setattr(Crew, "worker", given)
        told = []

        async def run():
            desk = Desk(Folder(tmp_path), lambda event: told.append(event) or act(desk, event))
            found = await judged(desk, PLAN, "two.plan.json")
            assert desk.judging == {}
            return found

        return lambda: asyncio.run(run()), told

    return judge


def test_pages_are_told_how_far_the_referee_is_and_that_it_is_done(on_desk):
    run, told = on_desk(Slow(5.0, 50.0))
    assert run() is PLAN
    states = [event["state"] for event in told]
    assert [state["seconds"] for state in states] == [5.0, 50.0, 50.0]
    assert [state["isOver"] for state in states] == [False, False, True]
    assert states[0]["file"] == "two.plan.json"
    assert states[0]["vehicles"] == 2


def test_a_plan_that_is_judged_in_no_time_is_nothing_to_tell(on_desk):
    run, told = on_desk(Slow())
    assert run() is PLAN
    assert told == []


def test_the_referee_is_given_up_by_what_it_took_of_a_processor(on_desk):
    run, told = on_desk(Slow(5.0, limit_of(PLAN) + 1.0, 9e9))
    with pytest.raises(CallError, match=r"two\.plan\.json: the referee took more than 60 s"):
        run()
    assert told[-1]["state"]["isOver"]
    assert 9e9 not in [event["state"]["seconds"] for event in told]


def test_who_ends_it_gets_no_plan_rather_than_one_that_nobody_judged(on_desk):
    run, told = on_desk(Slow(1.0), lambda desk, event: stop_judging(desk, "two.plan.json"))
    assert run() is None
    assert told[-1]["state"]["isOver"]


def test_larger_fleets_may_take_longer():
    many = SimpleNamespace(num_vehicles=512, obstacles=(), horizon=20)
    assert limit_of(SimpleNamespace(scenario=many)) > 5.0 * limit_of(PLAN)


def test_a_flight_is_one_by_its_first_line_whatever_it_is_called(tmp_path, monkeypatch):
    path = tmp_path / "harbor.flight.json"
    path.write_text('{"format": "radmpc/flight/1"}\n{}\n', encoding="utf-8")
    monkeypatch.setattr(opening, "_flight", lambda path: f"flown: {path.name}")
    assert opening.read_file(path, path.name) == "flown: harbor.flight.json"


def test_a_worker_tells_what_it_has_taken_while_it_is_at_it(monkeypatch):
    news, is_told = [], threading.Event()

    def tell(kind, seconds):
        news.append((kind, seconds))
        is_told.set()

    monkeypatch.setattr(judging, "_EVERY", 0.0)
    with judging._told(SimpleNamespace(tell=tell)):
        assert is_told.wait(30.0)
    count = len(news)
    assert {kind for kind, _ in news} == {"spent"}
    assert all(seconds >= 0.0 for _, seconds in news)
    assert len(news) == count
