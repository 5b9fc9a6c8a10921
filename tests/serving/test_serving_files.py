"""Files that several pages write, and what is found in a folder, without processes."""

from __future__ import annotations

import asyncio
import os
from types import SimpleNamespace

import pytest

from radmpc.serving import folder
from radmpc.serving.desk import files
from radmpc.serving.desk.calls import answer
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.flight import OpenFlight
from radmpc.serving.desk.opening import Opened
from radmpc.serving.documents import templates
from radmpc.serving.failures import CallError
from radmpc.serving.folder import Folder


@pytest.fixture
def desk(tmp_path, quiet_crew, monkeypatch):
    """A desk on an empty folder."""
    monkeypatch.setattr(Desk, "look_at", lambda self, document: None)
    return Desk(Folder(tmp_path), lambda event: None)


def test_of_two_documents_saved_at_once_under_one_new_name_one_is_refused(desk):
    async def save_both():
        documents = [await desk.add(Opened(templates.empty()), None) for _ in range(2)]
        return await asyncio.gather(
            *(
                answer(
                    desk,
                    "save",
                    {"document": one.number, "path": "new.yaml", "overwrite": False},
                )
                for one in documents
            ),
            return_exceptions=True,
        )

    saved, failure = asyncio.run(save_both())
    assert saved.state["file"] == "new.yaml"
    assert isinstance(failure, CallError)
    assert str(failure) == "new.yaml: it is there already"
    assert failure.kind == "exists"


@pytest.mark.parametrize("name", ["pipe.yaml", "pipe.jsonl", "pipe.kml"])
def test_a_named_pipe_is_not_listed_and_nobody_waits_for_it(desk, name):
    place = desk.folder.root / name
    os.mkfifo(place)
    keeper = os.open(place, os.O_RDWR)
    try:
        # Enough for who reads it all the same: without this, that one would wait for a writer.
        os.write(keeper, b"radmpc/scenario/1 radmpc/flight/1 " * 300)
        assert desk.folder.files() == []
    finally:
        os.close(keeper)


def test_a_file_that_is_gone_while_the_folder_is_listed_is_left_out(desk, monkeypatch):
    for name in ("a.yaml", "b.yaml"):
        (desk.folder.root / name).write_text("format: radmpc/scenario/1\n", encoding="utf-8")
    kind_of = folder._kind

    def look(place, *more):
        found = kind_of(place, *more)
        (desk.folder.root / "a.yaml").unlink(missing_ok=True)
        return found

    monkeypatch.setattr(folder, "_kind", look)
    assert [entry["path"] for entry in asyncio.run(answer(desk, "files", {}))] == ["b.yaml"]


def test_a_change_of_a_file_while_it_is_opened_is_not_overwritten_in_silence(desk, monkeypatch):
    place = desk.folder.root / "own.yaml"
    place.write_text(templates.template("boats"), encoding="utf-8")
    read = files.read_file

    def read_and_change(path, name):
        found = read(path, name)
        path.write_text("theirs", encoding="utf-8")
        return found

    monkeypatch.setattr(files, "read_file", read_and_change)

    async def open_and_save():
        state = await answer(desk, "open", {"path": "own.yaml"})
        args = {"document": state["document"], "path": "own.yaml", "overwrite": False}
        await answer(desk, "save", args)

    with pytest.raises(CallError, match="has changed since it was read"):
        asyncio.run(open_and_save())
    assert place.read_text(encoding="utf-8") == "theirs"


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("a.yaml", "name: \ud83d", "a.yaml: must be text that UTF-8 can encode"),
        ("a.kml", "\ud83d", "a.kml: must be text that UTF-8 can encode"),
        ("a.json", "[]", "a.json: must be a mapping with a format"),
        ("a.yaml", "boats", "a.yaml: must be a mapping with a format"),
        (
            "a.yaml",
            "format: radmpc/plan/9",
            "a.yaml: format must be radmpc/scenario/1 or radmpc/plan/1",
        ),
    ],
)
def test_what_is_dropped_and_no_file_of_ours_is_refused_by_its_name(desk, name, content, reason):
    with pytest.raises(CallError) as caught:
        asyncio.run(answer(desk, "drop", {"name": name, "content": content}))
    assert (caught.value.kind, str(caught.value)) == ("refused", reason)


def test_a_flight_is_not_written_where_another_one_is_being_written(desk, monkeypatch):
    monkeypatch.setattr(OpenFlight, "begin", lambda self, crew, args, **listeners: None)

    async def fly_both(*options):
        document = await desk.add(Opened(templates.empty()), None)
        scenario = SimpleNamespace(horizon=3, risk_bound=0.05)
        flown = SimpleNamespace(scenario=scenario, trajectories=(None,))
        desk.plans["p1"] = SimpleNamespace(plan=flown, number="p1", document=document.number)
        common = {"plan": "p1", "seed": 0, "pace": 0.0}
        calls = (answer(desk, "fly", {**common, "options": given}) for given in options)
        return await asyncio.gather(*calls, return_exceptions=True)

    log = {"log": "own.jsonl", "overwrite": True}
    first, second, third = asyncio.run(fly_both(log, log, {"log": "other.jsonl"}))
    assert (first["state"], third["state"]) == ("running", "running")
    assert isinstance(second, CallError)
    assert str(second) == "own.jsonl: a flight that is under way is written there"
