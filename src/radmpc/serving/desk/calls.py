"""What each call does; its arguments come from a page, which may send anything."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from radmpc.errors import RadmpcError
from radmpc.serving.desk import arguments as given
from radmpc.serving.desk import exporting, files
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.judging import stop_judging
from radmpc.serving.documents.content import check_changes
from radmpc.serving.documents.document import Document
from radmpc.serving.failures import CallError, refused
from radmpc.serving.protocol import CALLS
from radmpc.serving.work.asking import Asked, check_flight, check_planner
from radmpc.version import __version__

__all__ = ["answer"]

Args = Mapping[str, Any]

_LONGEST_SEARCH = 24.0 * 3600.0
"""Time limit of a search at most [s]."""

_MOST_SAMPLES = 20_000
"""Samples of one simulation [-]."""

_SIMULATION_SECONDS, _WHY_SECONDS = 120.0, 90.0
"""Seconds after which simulating, and looking for causes, are given up [s]."""


async def answer(desk: Desk, name: object, args: object) -> object:
    """Return the answer to a call.

    Parameters
    ----------
    desk : Desk
        What it is about.
    name, args : object
        As they came from the page.

    Raises
    ------
    CallError
        If it is refused, for whatever reason.
    """
    call = _CALLS.get(name) if isinstance(name, str) else None
    if call is None:
        raise refused(f"a call must be one of {', '.join(CALLS)}")
    if not isinstance(args, dict):
        raise refused("args must be a mapping")
    try:
        return await call(desk, args)
    except CallError:
        raise
    except RadmpcError as error:
        raise refused(str(error)) from error


async def _hello(desk: Desk, args: Args) -> object:
    """Say what there is."""
    del args
    if desk.opening is not None:
        # The file that the command named comes first; what is wrong with it ends the server.
        await asyncio.wait([desk.opening])
    desk.crew.prepare()
    planners, exports = await asyncio.to_thread(_choices)
    return {
        "version": __version__,
        "planners": planners,
        "exports": exports,
        "templates": files.templates(),
        "folder": desk.folder.root.name or "/",
        "documents": [
            {"document": one.number, "name": one.name} for one in desk.documents.values()
        ],
        "document": desk.first,
    }


def _choices() -> tuple[object, object]:
    """Return planners and formats of exports."""
    from radmpc.planners.presets import DEFAULT, PRESETS  # noqa: PLC0415 - after the first answer

    presets = sorted(PRESETS.values(), key=lambda preset: preset.name != DEFAULT)
    planners = [{"name": preset.name, "text": preset.summary} for preset in presets]
    return planners, exporting.exports()


async def _state(desk: Desk, args: Args) -> object:
    """Say how a document stands."""
    return desk.state(_document(desk, args))


async def _close(desk: Desk, args: Args) -> object:
    """Take a document off the desk."""
    desk.close(_document(desk, args))
    return None


async def _change(desk: Desk, args: Args) -> object:
    """Change a document."""
    document = _document(desk, args)
    changes = check_changes(args.get("changes"))
    await document.change(_revision(args), changes)
    return desk.changed(document)


async def _undo(desk: Desk, args: Args) -> object:
    """Undo the last change."""
    document = _document(desk, args)
    await document.undo(_revision(args))
    return desk.changed(document)


async def _redo(desk: Desk, args: Args) -> object:
    """Do again what was undone."""
    document = _document(desk, args)
    await document.redo(_revision(args))
    return desk.changed(document)


async def _plan(desk: Desk, args: Args) -> object:
    """Begin a search."""
    document = _document(desk, args)
    gap, bound = args.get("gap"), args.get("riskBound")
    asked = Asked(
        document.content,
        given.text(args, "planner"),
        given.number(args, "seconds", 0.1, _LONGEST_SEARCH),
        None if gap is None else given.number(args, "gap", 1e-9, 1.0),
        None if bound is None else given.number(args, "riskBound", 1e-9, 0.4999),
    )
    await asyncio.to_thread(check_planner, asked.planner)
    return desk.begin_search(document, asked).state


async def _stop(desk: Desk, args: Args) -> object:
    """End a search with its best plan."""
    search = desk.search(given.text(args, "search"))
    search.stop()
    return search.state


async def _pause(desk: Desk, args: Args) -> object:
    """Let a search stand still."""
    search = desk.search(given.text(args, "search"))
    search.pause()
    return search.state


async def _resume(desk: Desk, args: Args) -> object:
    """Let a search go on."""
    search = desk.search(given.text(args, "search"))
    search.resume()
    return search.state


async def _view(desk: Desk, args: Args) -> object:
    """Show a plan."""
    return await asyncio.to_thread(desk.plan(given.text(args, "plan")).view)


async def _why(desk: Desk, args: Args) -> object:
    """Look for what stands in the way, and try cures."""
    document = _document(desk, args)
    if document.reading.scenario is None:
        return document.remarks
    return await desk.crew.run("why", document.content, seconds=_WHY_SECONDS)


async def _simulate(desk: Desk, args: Args) -> object:
    """Fly a plan many times."""
    kept = desk.plan(given.text(args, "plan"))
    flights = given.integer(args, "flights", 1, _MOST_SAMPLES)
    seed = given.integer(args, "seed", 0, 2**32 - 1)
    if not kept.plan.trajectories:
        raise refused("there is nothing to simulate: no plan was found")
    key = (flights, seed)
    if key not in kept.trails:
        job = (kept.plan, kept.number, flights, seed)
        kept.trails.clear()
        kept.trails[key] = await desk.crew.run("simulate", *job, seconds=_SIMULATION_SECONDS)
    return kept.trails[key]


async def _fly(desk: Desk, args: Args) -> object:
    """Begin a flight."""
    kept = desk.plan(given.text(args, "plan"))
    seed = given.integer(args, "seed", 0, 2**32 - 1)
    pace = given.number(args, "pace", 0.0, 60.0)
    options = args.get("options", {})
    if not isinstance(options, dict):
        raise refused("options must be a mapping")
    known = {"with", "replan", "deadline", "log", "overwrite"}
    if not options.keys() <= known:
        raise refused(f"options must be among {', '.join(sorted(known))}")
    how = files.flight_options(desk, options)
    await asyncio.to_thread(check_flight, how)
    files.check_log(desk, how)
    flight = desk.begin_flight(kept, (seed, pace, how))
    flight.log = how.get("log")
    return flight.state


async def _stop_flight(desk: Desk, args: Args) -> object:
    """End a flight after its tick."""
    flight = desk.flight(given.text(args, "flight"))
    flight.stop()
    return flight.state


async def _flight(desk: Desk, args: Args) -> object:
    """Say how a flight stands."""
    return desk.flight(given.text(args, "flight")).state


async def _stop_judging(desk: Desk, args: Args) -> object:
    """End what the referee is at with a file's plan."""
    stop_judging(desk, given.text(args, "file"))
    return None


def _document(desk: Desk, args: Args) -> Document:
    """Return the document that a call is about."""
    return desk.document(given.text(args, "document"))


def _revision(args: Args) -> int:
    """Return the revision that a change is of."""
    return given.integer(args, "revision", 0, 2**53)


_CALLS: Mapping[str, Callable[[Desk, Args], Awaitable[object]]] = {
    "hello": _hello,
    "files": files.listed,
    "new": files.begun,
    "open": files.opened,
    "drop": files.dropped,
    "state": _state,
    "close": _close,
    "change": _change,
    "undo": _undo,
    "redo": _redo,
    "save": files.saved,
    "export": exporting.exported,
    "why": _why,
    "plan": _plan,
    "stop": _stop,
    "pause": _pause,
    "resume": _resume,
    "view": _view,
    "savePlan": files.plan_saved,
    "simulate": _simulate,
    "fly": _fly,
    "stopFlight": _stop_flight,
    "flight": _flight,
    "stopJudging": _stop_judging,
}
