"""The calls that read and write files."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from radmpc.io.text.yaml_text import read_yaml
from radmpc.model.plan import Plan
from radmpc.serving.desk import arguments as given
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.judging import judged
from radmpc.serving.desk.opening import Opened, is_chart, read_file
from radmpc.serving.desk.things import Changed
from radmpc.serving.documents import templates as kinds
from radmpc.serving.documents.document import Document
from radmpc.serving.documents.text import Original, text_of
from radmpc.serving.failures import exists, refused
from radmpc.serving.folder import CHARTS, FLIGHTS, SCENARIOS
from radmpc.serving.protocol import Named

__all__ = [
    "begun",
    "check_log",
    "dropped",
    "flight_options",
    "listed",
    "opened",
    "plan_saved",
    "saved",
    "templates",
]

Args = Mapping[str, Any]

_OPENED = (*SCENARIOS, *FLIGHTS, *CHARTS)

_MOST_DROPPED = 4 * 2**20
"""Letters of a file that is dropped on the page."""

_IMPORT_SECONDS = 60.0
"""Seconds that a chart may take [s]."""


def templates() -> list[Named]:
    """Return the scenarios to begin with."""
    return kinds.templates()


async def listed(desk: Desk, args: Args) -> object:
    """Return the files of the folder."""
    del args
    return await asyncio.to_thread(desk.folder.files)


async def begun(desk: Desk, args: Args) -> object:
    """Begin from a template, or from nothing."""
    kind = given.option(args, "template")
    if kind is None:
        opened = Opened(kinds.empty())
    else:
        text = kinds.template(kind)
        value, _ = read_yaml(text, kind)
        if not isinstance(value, dict):
            raise refused("a template must be a mapping")
        opened = Opened(value, Original(text))
    return desk.state(await desk.add(opened, None))


async def opened(desk: Desk, args: Args) -> object:
    """Open a file of the folder; one that is open already is shown as it is."""
    path = given.text(args, "path")
    place = desk.folder.readable(path, *_OPENED)
    name = desk.folder.name_of(place)
    for document in desk.documents.values():
        if document.file == name:
            return desk.state(document)
    reading = desk.reading.get(name)
    if reading is None:
        reading = asyncio.ensure_future(_added(desk, place, name))
        desk.reading[name] = reading
        reading.add_done_callback(lambda _: desk.reading.pop(name, None))
    # Who asks for it meanwhile gets the same document: two of one file would overwrite each other.
    return desk.state(await asyncio.shield(reading))


async def dropped(desk: Desk, args: Args) -> object:
    """Open a file that was dropped on the page: what it holds, wherever it was."""
    name = PurePosixPath(given.text(args, "name").replace("\\", "/")).name
    content = given.text(args, "content", _MOST_DROPPED)
    if not name.lower().endswith(_OPENED):
        raise refused(f"{name}: must end in {', '.join(_OPENED)}")
    into = None if args.get("into") is None else desk.document(given.text(args, "into"))
    with tempfile.TemporaryDirectory(prefix="radmpc-") as folder:
        place = Path(folder, f"dropped{PurePosixPath(name.lower()).suffix}")
        try:
            await asyncio.to_thread(place.write_text, content, encoding="utf-8")
        except UnicodeEncodeError:
            raise refused(f"{name}: must be text that UTF-8 can encode") from None
        if into is None:
            return desk.state(await _added(desk, place, name, is_kept=False))
        return await _merged(desk, into, place, name)


async def _added(desk: Desk, place: Path, name: str, *, is_kept: bool = True) -> Document:
    """Put a file on the desk, whichever it is."""
    if is_chart(name):
        seconds = _IMPORT_SECONDS
        content = await desk.crew.run("import", str(place), name, seconds=seconds)
        return await desk.add(Opened(content), None)
    # Before it is read: what is written meanwhile is then seen to be another.
    digest = await asyncio.to_thread(desk.folder.digest, place)
    found = await asyncio.to_thread(read_file, place, name)
    if found.plan is not None and found.plan.trajectories:
        plan = await judged(desk, found.plan, name)
        # Who does not want to wait for the referee gets the scenario alone.
        ticks = None if plan is None else found.ticks
        found = Opened(found.content, found.origin, found.is_scenario, plan, ticks)
    document = await desk.add(found, name if is_kept else None)
    document.digest = digest if document.file is not None else None
    return document


async def _merged(desk: Desk, document: Document, place: Path, name: str) -> object:
    """Add the obstacles of a chart, or of another scenario, to a document."""
    if is_chart(name):
        seconds = _IMPORT_SECONDS
        job = ("obstacles", str(place), name, document.content)
        found = await desk.crew.run(*job, seconds=seconds)
    else:
        content = (await asyncio.to_thread(read_file, place, name)).content
        found = content.get("obstacles") or []
        if not isinstance(found, list) or not all(isinstance(entry, dict) for entry in found):
            raise refused(f"{name}: obstacles must be a list of mappings")
    ours = document.content.get("obstacles")
    entries = list(ours) if isinstance(ours, list) else []
    taken = {str(entry.get("name")) for entry in entries if isinstance(entry, dict)}
    for entry in found:
        fresh, count = str(entry.get("name", "obstacle")), 1
        while fresh in taken:
            count += 1
            fresh = f"{entry.get('name', 'obstacle')} {count}"
        taken.add(fresh)
        entries.append({**entry, "name": fresh})
    await document.change(document.revision, [{"path": ["obstacles"], "value": entries}])
    return desk.changed(document)


async def saved(desk: Desk, args: Args) -> object:
    """Write a document to a file of the folder, with the comments that it was read with."""
    document = desk.document(given.text(args, "document"))
    path = given.text(args, "path")
    overwrite = given.flag(args, "overwrite")
    place = _place_of(desk, document, path, overwrite=overwrite)
    async with document.lock:
        content = document.content
        suffix = place.suffix.lower()
        text = await asyncio.to_thread(text_of, content, suffix, document.origin)
        async with desk.folder.lock:
            place = _place_of(desk, document, path, overwrite=overwrite)
            await asyncio.to_thread(desk.folder.write, place, text)
            document.digest = desk.folder.digest(place)
        document.saved_as(desk.folder.name_of(place), content)
        if suffix != ".json":
            document.origin = Original(text)
    return Changed(desk.state(document))


def _place_of(desk: Desk, document: Document, path: str, *, overwrite: bool) -> Path:
    """Return where a document may be written: over its own file, if nobody else has changed it."""
    is_its_own = document.file == path
    place = desk.folder.writable(path, *SCENARIOS, overwrite=overwrite or is_its_own)
    if not overwrite and place.exists() and desk.folder.digest(place) != document.digest:
        raise exists(path, ", and has changed since it was read")
    return place


async def plan_saved(desk: Desk, args: Args) -> object:
    """Write a plan to a file of the folder."""
    kept = desk.plan(given.text(args, "plan"))
    path, overwrite = given.text(args, "path"), given.flag(args, "overwrite")
    desk.folder.writable(path, ".json", overwrite=overwrite)
    text = await asyncio.to_thread(_plan_text, kept.plan)
    async with desk.folder.lock:
        place = desk.folder.writable(path, ".json", overwrite=overwrite)
        await asyncio.to_thread(desk.folder.write, place, text)
    return None


def _plan_text(plan: Plan) -> str:
    """Return a plan as its file has it."""
    from radmpc.io.native.plan_file import encode_plan  # noqa: PLC0415 - after the first answer
    from radmpc.io.text.json_text import write_json  # noqa: PLC0415 - after the first answer

    return write_json(encode_plan(plan))


def flight_options(desk: Desk, options: Mapping[str, Any]) -> dict[str, object]:
    """Return how a plan is flown: a log's place within the folder, all else as it is.

    Parameters
    ----------
    desk : Desk
        Whose folder.
    options : mapping
        As they came from the page.
    """
    found = dict(options)
    for key in ("with", "replan", "log"):
        given.option(options, key)
    log = found.pop("log", None)
    overwrite = bool(found.pop("overwrite", False))
    if log is not None:
        found["log"] = str(desk.folder.writable(log, *FLIGHTS, overwrite=overwrite))
    if found.get("deadline") is not None:
        found["deadline"] = given.number(options, "deadline", 0.0, 60.0)
    return found


def check_log(desk: Desk, how: Mapping[str, object]) -> None:
    """Refuse a log that another flight is writing, or is about to: the later would replace it.

    Parameters
    ----------
    desk : Desk
        Whose flights.
    how : mapping
        As `flight_options` returns it.

    Raises
    ------
    CallError
        If there is such a flight.
    """
    log = how.get("log")
    if log is None:
        return
    if any(flight.log == log and not flight.is_over for flight in desk.flights.values()):
        name = desk.folder.name_of(Path(str(log)))
        raise refused(f"{name}: a flight that is under way is written there")
