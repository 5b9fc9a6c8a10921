"""A whole flight: missions one after the other, every tick on the disk before it is flown."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack

import numpy as np

from radmpc.arguments import check_callable, check_kind, check_path, value_text
from radmpc.arrays import Vector
from radmpc.errors import ArgumentTypeError, FileFormatError, ScenarioError
from radmpc.flying.backends import Backend, backend_named
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.tick import Contact, segments
from radmpc.io.flight.flight_file import FlightWriter
from radmpc.io.flight.record import FlightRecord, FlightSettings, TickRow
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.presets import parse_planner
from radmpc.planning import check_takes
from radmpc.solvers.solution import never
from radmpc.version import __version__

__all__ = ["Progress", "begin_flight", "check_replan", "may_go_on", "resume_flight"]

Progress = Callable[[int, int], None]
"""Takes the number of the mission and its step, of every tick."""

_CLOSE = 1e-9
"""Difference of states, absolute below one and relative above, up to which a backend that is flown
again is where it was [-]."""

States = Sequence[Vector]


def begin_flight(
    plan: Plan,
    settings: FlightSettings,
    path: str | os.PathLike[str] | None = None,
    *,
    stop: Callable[[], bool] = never,
    progress: Progress | None = None,
) -> FlightRecord:
    """Fly a plan, and write down every tick before it is flown.

    Parameters
    ----------
    plan : Plan
        What is flown.
    settings : FlightSettings
        With what, and how often.
    path : path or None
        The flight file; None writes none.
    stop : callable
        Whether to end after the tick.
    progress : callable or None
        Called with every tick.

    Returns
    -------
    FlightRecord
        What was flown; if it was stopped, the last mission is not over.

    Raises
    ------
    ArgumentTypeError
        If an argument is of another kind.
    RadmpcError
        If the plan cannot be flown, or not with this backend.
    OSError
        If the file cannot be written.
    """
    check_plan(plan)
    check_kind(settings, FlightSettings, "settings", "a FlightSettings")
    if path is not None:
        check_path(path)
    _check_told(stop, progress)
    record = FlightRecord(plan, settings, (), (), {"radmpc": __version__})
    check_replan(plan.scenario, settings)
    # Before the file is touched: a plan that cannot be flown leaves nothing behind.
    _mission(record, 0, lambda row: None)
    ready = [_backend(record, 0)]
    try:
        with ExitStack() as stack:
            writer = None
            if path is not None:
                begun = FlightWriter.begin(path, plan, settings, record.versions)
                writer = stack.enter_context(begun)
            return _flown(record, writer, stop, progress, ready)
    finally:
        for backend in ready:
            _close(backend)


def _check_told(stop: object, progress: object) -> None:
    """Refuse what cannot be called to ask or to tell."""
    if not callable(stop):
        raise ArgumentTypeError(f"stop must be a function, got {value_text(stop)}")
    check_callable(progress, "progress")


def check_replan(scenario: Scenario, settings: FlightSettings) -> None:
    """Refuse a planner that cannot plan anew what is flown: at every step it would fail.

    Flights that were begun go on with whatever planner they have.

    Parameters
    ----------
    scenario : Scenario
        Of the plan that is flown.
    settings : FlightSettings
        With the planner's name; none flies the plan as it is.

    Raises
    ------
    ScenarioError
        If there is no such planner, or the scenario has what it does not take.
    """
    if settings.replan is None:
        return
    planner = parse_planner(settings.replan)
    try:
        check_takes(scenario, planner)
    except ScenarioError as error:
        raise ScenarioError(f"cannot plan anew with {settings.replan!r}: {error}") from error


def resume_flight(
    path: str | os.PathLike[str],
    *,
    stop: Callable[[], bool] = never,
    progress: Progress | None = None,
) -> FlightRecord:
    """Go on with a flight from its file, however it ended.

    The account is recomputed from the rows. The backend is flown again with the recorded
    controls: model and simulators are then where they were.

    Parameters
    ----------
    path : path
        The flight file; what is flown is added to it.
    stop, progress
        As in `begin_flight`.

    Returns
    -------
    FlightRecord
        What was flown, before and now.

    Raises
    ------
    FileFormatError
        If the file was changed, or the backend does not come to where it was.
    RadmpcError
        If the plan cannot be flown, or not with this backend.
    OSError
        If the file cannot be written.
    """
    check_path(path)
    _check_told(stop, progress)
    writer, record = FlightWriter.go_on(path)
    with writer:
        try:
            _check_repeats(record)
            return _flown(record, writer, stop, progress, [])
        except FileFormatError as error:
            raise FileFormatError(f"{os.fspath(path)}: {error}") from error


def _flown(
    record: FlightRecord,
    writer: FlightWriter | None,
    stop: Callable[[], bool],
    progress: Progress | None,
    ready: list[Backend],
) -> FlightRecord:
    """Fly the missions that are left, the first with a backend that is taken from those ready."""
    rows = list(record.rows)

    def tell(row: TickRow) -> None:
        if writer is not None:
            writer.append(row)
        rows.append(row)
        if progress is not None:
            progress(row.mission, row.step)

    missions = record.missions
    begun = missions[-1] if missions and not missions[-1].is_over else None
    if begun is not None:
        _fly(record, begun.number, begun.rows, tell, stop, ready)
    for number in range(len(missions), record.settings.missions):
        if stop():
            break
        _fly(record, number, (), tell, stop, ready)
    return FlightRecord(record.plan, record.settings, tuple(rows), (), record.versions)


def _fly(
    record: FlightRecord,
    number: int,
    past: Sequence[TickRow],
    tell: Callable[[TickRow], None],
    stop: Callable[[], bool],
    ready: list[Backend],
) -> None:
    """Fly one mission to its end, or until it is to stop."""
    mission = _mission(record, number, tell, past)
    backend = ready.pop() if ready else _backend(record, number)
    try:
        states, contacts = _replayed(backend, record.plan.scenario, past)
        while not mission.is_over and not stop():
            tick = mission.step(states, deadline=record.settings.deadline, contacts=contacts)
            if tick.segments:
                states, contacts = backend.advance(tick.segments)
    finally:
        _close(backend)


def may_go_on(record: FlightRecord) -> bool:
    """Whether what a flight is flown with can come to where it was: vehicles have moved on.

    Parameters
    ----------
    record : FlightRecord
        The flight so far.
    """
    is_between = all(mission.is_over for mission in record.missions)
    return is_between or backend_named(record.settings.backend).repeats


def _check_repeats(record: FlightRecord) -> None:
    """Refuse to go on with a mission whose vehicles are not where they were."""
    if not may_go_on(record):
        under_way = [mission for mission in record.missions if not mission.is_over]
        raise FileFormatError(
            f"cannot go on: {record.settings.backend} does not repeat the {len(under_way[0].rows)} "
            f"steps of mission {under_way[0].number + 1}, the vehicles have moved on"
        )


def _close(backend: Backend) -> None:
    """Close a backend that can be closed: a link to vehicles, a window."""
    close = getattr(backend, "close", None)
    if callable(close):
        close()


def _mission(
    record: FlightRecord,
    number: int,
    tell: Callable[[TickRow], None],
    past: Sequence[TickRow] = (),
) -> RecordedMission:
    """Return a mission of a flight."""
    settings = record.settings
    return RecordedMission(
        record.plan, number, tell, past, planner=settings.replan, seed=settings.seed
    )


def _backend(record: FlightRecord, number: int) -> Backend:
    """Return what a mission is flown with; its noise is the mission's own."""
    settings = record.settings
    rng = np.random.default_rng([settings.seed, number])
    kind = backend_named(settings.backend)
    kind.check_options(settings.options)
    return kind.make(record.plan.scenario, rng, **settings.options)


def _replayed(
    backend: Backend, scenario: Scenario, past: Sequence[TickRow]
) -> tuple[States, Sequence[Contact]]:
    """Return where a backend is after the controls of some rows."""
    states, contacts = backend.reset()
    for row in past:
        if row.states is not None:
            _check_same(scenario, states, row)
        if row.controls:
            known = tuple(states) if row.states is None else row.states
            states, contacts = backend.advance(segments(scenario, known, row.controls))
    return states, contacts


def _check_same(scenario: Scenario, states: States, row: TickRow) -> None:
    """Refuse a backend that is elsewhere than recorded: vehicles, or another version of it."""
    for vehicle, now, then in zip(scenario.vehicles, states, row.states or (), strict=True):
        if not np.allclose(now, then, rtol=_CLOSE, atol=_CLOSE):
            raise FileFormatError(
                f"cannot go on: at step {row.step} of mission {row.mission + 1} vehicle "
                f"{vehicle.name!r} was at {np.asarray(then).tolist()}, flown again it is at "
                f"{np.asarray(now).tolist()}"
            )
