"""The desk: everything that is open on a server, whichever page looks at it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from itertools import count
from typing import Any

from radmpc.model.plan import Plan
from radmpc.serving.desk.flight import OpenFlight
from radmpc.serving.desk.kept import KeptPlan
from radmpc.serving.desk.looking import Lookout
from radmpc.serving.desk.opening import Opened
from radmpc.serving.desk.search import Search
from radmpc.serving.desk.things import Changed, forget, thing_of
from radmpc.serving.documents.document import Document
from radmpc.serving.failures import CallError, refused
from radmpc.serving.folder import Folder
from radmpc.serving.processes.crew import Crew
from radmpc.serving.protocol import DocumentState, TickView
from radmpc.serving.work.asking import Asked, Ended

__all__ = ["Desk", "Tell"]

Tell = Callable[[Mapping[str, Any]], None]
"""Takes an event, for every page."""

_MOST_DOCUMENTS, _MOST_SEARCHES, _MOST_FLIGHTS = 20, 4, 2
"""Documents that are open, and searches and flights at once."""

_MOST_PASSED = 12
"""Plans kept of one search besides the one it ends with."""

_MOST_KEPT, _MOST_ENDED = 200, 40
"""Plans, and ended searches and flights, that a document keeps."""


class Desk:
    """Documents, plans, searches and flights, and who does the work.

    Parameters
    ----------
    folder : Folder
        Where files are.
    tell : callable
        Takes events.
    """

    def __init__(self, folder: Folder, tell: Tell) -> None:
        self.folder, self.tell = folder, tell
        self.crew = Crew()
        self.documents: dict[str, Document] = {}
        self.plans: dict[str, KeptPlan] = {}
        self.searches: dict[str, Search] = {}
        self.flights: dict[str, OpenFlight] = {}
        self.first: str | None = None
        self.opening: asyncio.Task[None] | None = None
        self.judging: dict[str, asyncio.Future[Plan]] = {}
        self.reading: dict[str, asyncio.Future[Document]] = {}
        self._numbers = {kind: count(1) for kind in "dpsf"}
        self._lookout = Lookout(self.crew, self._seen)

    def document(self, number: str) -> Document:
        """Return a document.

        Raises
        ------
        CallError
            If it is not open.
        """
        return thing_of(self.documents, number, "document")

    def plan(self, number: str) -> KeptPlan:
        """Return a plan that is kept; see `document`."""
        return thing_of(self.plans, number, "plan")

    def search(self, number: str) -> Search:
        """Return a search; see `document`."""
        return thing_of(self.searches, number, "search")

    def flight(self, number: str) -> OpenFlight:
        """Return a flight; see `document`."""
        return thing_of(self.flights, number, "flight")

    def state(self, document: Document) -> DocumentState:
        """Return what pages are told of a document."""
        number = document.number
        return {
            "document": number,
            "revision": document.revision,
            "content": document.content,
            "view": document.view,
            "remarks": document.remarks,
            "canUndo": document.can_undo,
            "canRedo": document.can_redo,
            "file": document.file,
            "isSaved": document.is_saved,
            "plans": [p.summary for p in self.plans.values() if p.document == number],
            "searches": [s.state for s in self.searches.values() if s.document == number],
            "flights": [f.state for f in self.flights.values() if f.document == number],
        }

    async def add(self, opened: Opened, file: str | None) -> Document:
        """Put what a file holds on the desk.

        Parameters
        ----------
        opened : Opened
            What it holds.
        file : str or None
            Where; None was not in the folder.

        Raises
        ------
        CallError
            If too many documents are open.
        """
        own = file if opened.is_scenario else None
        document = Document(self._number("d"), opened.content, own, opened.origin)
        await document.read()
        # Others may have been added while it was read.
        if len(self.documents) >= _MOST_DOCUMENTS:
            raise CallError("limit", f"{_MOST_DOCUMENTS} documents are open: close one")
        self.documents[document.number] = document
        self.first = self.first or document.number
        if opened.plan is not None:
            kept = KeptPlan.of(self._number("p"), document.number, opened.plan, 0)
            self.plans[kept.number] = kept
            if opened.ticks is not None:
                self._add_flown(kept, opened)
        self.crew.prepare()
        self.look_at(document)
        return document

    def close(self, document: Document) -> None:
        """Take a document off the desk, and all that is of it."""
        number = document.number
        for search in [s for s in self.searches.values() if s.document == number]:
            search.stop()
            del self.searches[search.number]
        for flight in [f for f in self.flights.values() if f.document == number]:
            flight.stop()
            del self.flights[flight.number]
        for plan in [p for p in self.plans.values() if p.document == number]:
            del self.plans[plan.number]
        del self.documents[number]
        if self.first == number:
            self.first = next(iter(self.documents), None)

    def changed(self, document: Document) -> Changed:
        """Return the answer to who has changed a document; every other page is told."""
        self.look_at(document)
        return Changed(self.state(document))

    def look_at(self, document: Document) -> None:
        """Have a document looked at before it is planned, once it rests."""
        self._lookout.look_at(document)

    def begin_search(self, document: Document, asked: Asked) -> Search:
        """Begin to plan a document.

        Parameters
        ----------
        document : Document
            Which.
        asked : Asked
            How.

        Raises
        ------
        CallError
            If something is wrong with it, or too many searches are under way.
        """
        if document.reading.scenario is None:
            wrong = document.remarks[0]
            raise refused(wrong["text"], wrong["path"])
        if sum(not search.is_over for search in self.searches.values()) >= _MOST_SEARCHES:
            raise CallError("limit", f"{_MOST_SEARCHES} searches are under way: stop one")
        search = Search(
            self._number("s"),
            document.number,
            document.revision,
            asked,
            changed=self._search_changed,
            improved=self._improved,
        )
        forget(self.searches, document.number, _MOST_ENDED)
        self.searches[search.number] = search
        search.begin(self.crew)
        return search

    def begin_flight(self, kept: KeptPlan, args: tuple[object, ...]) -> OpenFlight:
        """Begin to fly a plan.

        Parameters
        ----------
        kept : KeptPlan
            Which.
        args : tuple
            What the job takes besides.

        Raises
        ------
        CallError
            If it has no trajectories, or too many flights are under way.
        """
        if not kept.plan.trajectories:
            raise refused("there is nothing to fly: no plan was found")
        if sum(not flight.is_over for flight in self.flights.values()) >= _MOST_FLIGHTS:
            raise CallError("limit", f"{_MOST_FLIGHTS} flights are under way: stop one")
        scenario = kept.plan.scenario
        whose = (self._number("f"), kept.document, kept.number)
        flight = OpenFlight(*whose, scenario.horizon, scenario.risk_bound)
        forget(self.flights, kept.document, _MOST_ENDED)
        self.flights[flight.number] = flight
        job = (kept.plan, *args)
        flight.begin(self.crew, job, changed=self._flight_changed, ticked=self._ticked)
        return flight

    def end(self) -> None:
        """End whatever is under way."""
        self._lookout.end()
        self.crew.end()

    def _number(self, kind: str) -> str:
        """Return a new name for a thing."""
        return f"{kind}{next(self._numbers[kind])}"

    def _add_flown(self, kept: KeptPlan, opened: Opened) -> None:
        """Put a flight that was read from its file on the desk."""
        scenario = kept.plan.scenario
        flight = OpenFlight(
            self._number("f"),
            kept.document,
            kept.number,
            scenario.horizon,
            scenario.risk_bound,
            ticks=opened.ticks or (),
            note=opened.note,
        )
        self.flights[flight.number] = flight

    def _seen(self, document: Document) -> None:
        """Tell what was seen of a document."""
        if document.number in self.documents:
            self.tell({"event": "document", "state": self.state(document)})

    def _search_changed(self, search: Search) -> None:
        """Tell every page how a search stands."""
        if search.number in self.searches:
            self.tell({"event": "search", "state": search.state})

    def _improved(self, search: Search, plan: Plan, ended: Ended | None) -> None:
        """Keep a plan that a search has found."""
        if search.document not in self.documents:
            return
        # The plan that a search ends with was mostly its last better one: it stands there once.
        thing_of = next((p for p in self._passed(search) if p.is_of_same_paths(plan)), None)
        kept = KeptPlan.of(
            self._number("p") if thing_of is None else thing_of.number,
            search.document,
            plan,
            search.revision,
            remarks=() if ended is None else ended.remarks,
            search=search.number,
            is_final=ended is not None,
        )
        if thing_of is not None:
            kept.trails.update(self.plans.pop(thing_of.number).trails)
        self._forget_plans(search)
        self.plans[kept.number] = kept
        said = {"document": kept.document, "summary": kept.summary, "search": search.number}
        self.tell({"event": "plan", **said})

    def _passed(self, search: Search) -> list[KeptPlan]:
        """Return the plans that a search has found and gone on from, the oldest first."""
        return [p for p in self.plans.values() if p.search == search.number and not p.is_final]

    def _forget_plans(self, search: Search) -> None:
        """Make room: the oldest plans that a search has passed, then the oldest of all."""
        passed = self._passed(search)
        for plan in passed[: max(0, len(passed) - _MOST_PASSED)]:
            del self.plans[plan.number]
        of_document = [p for p in self.plans.values() if p.document == search.document]
        for plan in of_document[: max(0, len(of_document) - _MOST_KEPT)]:
            del self.plans[plan.number]

    def _flight_changed(self, flight: OpenFlight) -> None:
        """Tell every page how a flight stands."""
        if flight.number in self.flights:
            self.tell({"event": "flight", "state": flight.state})

    def _ticked(self, flight: OpenFlight, tick: TickView) -> None:
        """Tell every page of a tick."""
        if flight.number in self.flights:
            self.tell({"event": "tick", "flight": flight.number, "tick": tick})
