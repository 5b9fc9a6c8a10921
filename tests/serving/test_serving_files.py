"""Files that several pages write, and what is found in a folder, without processes."""

from __future__ import annotations

import asyncio

import pytest

from radmpc.serving.desk.calls import answer
from radmpc.serving.desk.desk import Desk
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
