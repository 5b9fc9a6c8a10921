"""Documents that are looked at while they change."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

from radmpc.serving.desk.looking import Lookout


def test_a_document_that_changes_is_looked_at_once_it_rests_and_nothing_is_broken_off(monkeypatch):
    monkeypatch.setattr("radmpc.serving.desk.looking._PAUSE", 0.01)
    reading = SimpleNamespace(scenario=object())
    document = SimpleNamespace(
        number="d1", revision=0, content={"revision": 0}, reading=reading, concerns=()
    )
    looked, seen = [], []

    async def run(job, content, *, seconds):
        looked.append(content["revision"])
        await asyncio.sleep(0.05)
        return [content["revision"]]

    def change(lookout):
        document.revision += 1
        document.content = {"revision": document.revision}
        lookout.look_at(document)

    async def story():
        lookout = Lookout(SimpleNamespace(run=run), lambda one: seen.append(one.concerns))
        for _ in range(5):
            change(lookout)
        await asyncio.sleep(0.03)  # it looks at the fifth
        change(lookout)
        change(lookout)
        while lookout._tasks:
            await asyncio.sleep(0.01)

    asyncio.run(story())
    assert looked == [5, 7]
    assert seen == [(7,)]
