"""What a desk keeps, and where it says that there is too much, without processes."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.native.scenario_file import save_scenario
from radmpc.model.plan import Status
from radmpc.serving.desk.calls import answer
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.opening import Opened
from radmpc.serving.desk.search import Search
from radmpc.serving.failures import CallError
from radmpc.serving.folder import Folder
from radmpc.serving.views.flight import tick_view
from radmpc.serving.web.socket import Page, Pages
from radmpc.serving.work.asking import Asked, Ended

SCENARIO = paper(2, 1)


@pytest.fixture
def desk(tmp_path, quiet_crew, monkeypatch):
    """A desk whose searches are begun and go nowhere."""
    monkeypatch.setattr(Search, "begin", lambda self, crew: None)
    monkeypatch.setattr(Desk, "look_at", lambda self, document: None)
    told = []
    made = Desk(Folder(tmp_path), told.append)
    made.told = told
    return made


def opened(desk):
    """Return a document on a desk."""
    return asyncio.run(desk.add(Opened(encode_scenario(SCENARIO)), None))


def asked(desk, document):
    """Begin a search."""
    return desk.begin_search(document, Asked(document.content, "certified", 5.0))


def drawn(cost, push=0.0):
    """Return a plan of two vehicles; a push makes another one."""
    tracks = []
    for vehicle in SCENARIO.vehicles:
        controls = np.full((SCENARIO.horizon, 2), push)
        means = np.zeros((SCENARIO.horizon + 1, 4))
        covariances = vehicle.covariances(SCENARIO.horizon)
        tracks.append(radmpc.Trajectory(vehicle.name, controls, means, covariances))
    return radmpc.Plan(
        scenario=SCENARIO, planner="drawn", seed=0, status=Status.FEASIBLE, cost=cost,
        lower_bound=None, risk=radmpc.Risk(SCENARIO.risk_bound, 0.001), sets=(("v1", "v2"),),
        trajectories=tuple(tracks),
    )  # fmt: skip


def test_the_plan_that_a_search_ends_with_stands_once_in_the_list(desk):
    document = opened(desk)
    search = asked(desk, document)
    for plan in (drawn(3.0, 0.1), drawn(2.0)):
        desk._improved(search, plan, None)
    [first, second] = desk.state(document)["plans"]
    desk.plan(second["plan"]).trails[5, 0] = {"flights": 5}
    ended = replace(drawn(2.0), lower_bound=1.5, status=Status.OPTIMAL)
    desk._improved(search, ended, Ended(ended, ()))
    plans = desk.state(document)["plans"]
    assert [plan["plan"] for plan in plans] == [first["plan"], second["plan"]]
    # It is known under its name, with what the end says of it.
    assert (plans[-1]["status"], plans[-1]["bound"]) == ("optimal", 1.5)
    assert desk.plan(second["plan"]).trails == {(5, 0): {"flights": 5}}
    assert desk.told[-1]["summary"] == plans[-1]


def test_a_plan_that_is_told_at_the_end_alone_is_one_that_was_found(desk):
    search = asked(desk, opened(desk))
    search._finish(Ended(drawn(2.0), ()))
    assert (search.state["found"], search.state["cost"]) == (1, 2.0)


def test_a_last_plan_that_differs_stands_beside_the_others(desk):
    document = opened(desk)
    search = asked(desk, document)
    desk._improved(search, drawn(2.0), None)
    desk._improved(search, drawn(2.0, 0.1), Ended(drawn(2.0, 0.1), ()))
    # Another search may find the same; that is told, too.
    desk._improved(asked(desk, document), drawn(2.0), None)
    assert len(desk.state(document)["plans"]) == 3


def test_a_fifth_search_is_refused_until_one_of_four_is_over(desk):
    document = opened(desk)
    first, *_ = [asked(desk, document) for _ in range(4)]
    with pytest.raises(CallError, match=r"^4 searches are under way: stop one$") as caught:
        asked(desk, document)
    assert caught.value.kind == "limit"
    first._end("done")
    assert asked(desk, document).state["state"] == "running"
    with pytest.raises(CallError):
        asked(desk, document)


class Deaf:
    """A socket whose page neither reads nor says anything."""

    def __init__(self):
        self.closed = None

    async def send_text(self, text):
        await asyncio.Event().wait()

    async def receive_text(self):
        await asyncio.Event().wait()

    async def close(self, code, reason):
        self.closed = code, reason


def test_a_page_is_slow_once_513_messages_wait_for_it():
    page = Page(Deaf())
    for number in range(512):
        page.put(str(number))
    assert not page.is_slow.is_set()
    page.put("one more")
    assert page.is_slow.is_set()
    assert page.queue.qsize() == 512


def test_a_page_that_reads_nothing_is_let_go_and_no_longer_told():
    async def told():
        pages, socket = Pages(), Deaf()
        serving = asyncio.create_task(pages.serve(socket, None))
        await asyncio.sleep(0)
        for _ in range(514):  # one is under way, 512 wait
            pages.tell({"event": "search"})
            await asyncio.sleep(0)
        await asyncio.wait_for(serving, 10.0)
        return socket.closed, pages._pages

    assert asyncio.run(told()) == ((1013, "too slow"), set())


@pytest.mark.parametrize(
    ("tail", "bank", "left"),
    [
        (0.03, 0.01, 0.04),
        (0.0123456, 0.0, 0.0123456),  # five digits would be more than Δ
        (0.0123456 * (1 + 1e-6), 0.0, 0.0123456),
        (0.02, 0.0, 0.02),  # bad news, as it is
    ],
)
def test_what_a_tick_has_left_is_above_its_bound_only_by_bad_news(tail, bank, left):
    row = SimpleNamespace(
        tail=tail, bank=bank, states=None, contacts=(), alarms=(), step=0, reason="kept",
        leg=None, seconds=0.0,
    )  # fmt: skip
    view = tick_view(row, SCENARIO, 0.0123456 if left != 0.04 else 0.05)
    assert view["left"] == left
    assert view["spent"] == pytest.approx(0.01 if left == 0.04 else 0.0, abs=1e-9)


def test_a_file_that_two_pages_open_at_once_is_one_document(desk, tmp_path):
    save_scenario(SCENARIO, tmp_path / "two.json")

    async def both():
        calls = (answer(desk, "open", {"path": "two.json"}) for _ in range(2))
        return await asyncio.gather(*calls)

    first, second = asyncio.run(both())
    assert first["document"] == second["document"]
    assert len(desk.documents) == 1


def test_a_file_that_could_not_be_opened_can_be_opened_once_it_is_right(desk, tmp_path):
    path = tmp_path / "two.json"
    path.write_text("{", encoding="utf-8")

    async def twice():
        with pytest.raises(CallError):
            await answer(desk, "open", {"path": "two.json"})
        save_scenario(SCENARIO, path)
        return await answer(desk, "open", {"path": "two.json"})

    assert asyncio.run(twice())["file"] == "two.json"


def test_as_many_documents_are_open_as_may_be_though_all_are_asked_for_at_once(desk):
    async def many():
        calls = (answer(desk, "new", {"template": None}) for _ in range(24))
        return await asyncio.gather(*calls, return_exceptions=True)

    failed = [one for one in asyncio.run(many()) if isinstance(one, CallError)]
    assert len(desk.documents) == 20
    assert {failure.kind for failure in failed} == {"limit"}


def test_a_search_that_was_stopped_is_not_held_on_its_way_to_the_end():
    signals = []
    worker = SimpleNamespace(
        stop=lambda: signals.append("stop"),
        hold=lambda: signals.append("hold"),
        go_on=lambda: signals.append("go on"),
    )

    async def stopped_and_held():
        search = Search("s1", "d1", 0, None, changed=signals.append, improved=signals.append)
        search._worker = worker
        search.stop()
        search.pause()
        return search._held_since

    assert asyncio.run(stopped_and_held()) is None
    assert signals == ["stop"]
