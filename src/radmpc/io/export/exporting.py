"""A plan in any of the formats known here: content of files, names, warnings."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import NoneType

from radmpc.arguments import check_kind, check_path, is_number, value_text
from radmpc.errors import ArgumentTypeError, ScenarioError
from radmpc.geodesy import Origin
from radmpc.io.export.geojson import write_geojson
from radmpc.io.export.job import Job
from radmpc.io.export.kml import write_kml
from radmpc.io.export.names import distinct, file_part
from radmpc.io.export.origin import Placement, scenario_origin
from radmpc.io.export.qgc import write_qgc
from radmpc.io.export.ros2 import write_mcap
from radmpc.io.export.statements import height_sentence, timing_sentence
from radmpc.io.export.table import write_table
from radmpc.io.export.tracks import TimedPath, thinned_tracks, tracks_of
from radmpc.io.export.waypoints import write_waypoints
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.records import dataclass
from radmpc.system.atomic import write_bytes

__all__ = [
    "FORMATS",
    "ROUNDING",
    "ExportOptions",
    "Exported",
    "Origin",
    "export_plan",
    "save_export",
    "save_exported",
]

_FLEET: Mapping[str, Callable[[Job], bytes]] = {
    "geojson": write_geojson,
    "kml": write_kml,
    "mcap": write_mcap,
    "csv": write_table,
}
_SINGLE: Mapping[str, Callable[[Job, TimedPath], bytes]] = {
    "qgc": write_qgc,
    "waypoints": write_waypoints,
}

_LEVEL = (*_SINGLE, "kml")
"""Formats whose heights are above home or ground, which are level."""

FORMATS = (*_SINGLE, *_FLEET)

ROUNDING: Mapping[str, float] = {"qgc": 0.022, "waypoints": 0.022}
"""By how much positions of a format may be off those of the plan [m], 1 mm where it is not listed:
MAVLink rounds to 1.1 cm, and steps less than a centimeter from the last waypoint are left out."""


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """What a plan does not say.

    Attributes
    ----------
    origin : Origin or None
        Where the local frame lies; None takes that of the scenario's source.
    altitude : float or None
        Height of a 2-D plan above the origin [m]; None is 0.
    is_certified : bool or None
        Whether the plan holds within its bound; None takes the plan's own word.
    steps : mapping or None
        The steps that are written of each vehicle, by its name, the first and the last among them;
        None is all. `radmpc.thin` finds some that are certified.
    note : str or None
        What the files say of that.
    """

    origin: Origin | None = None
    altitude: float | None = None
    is_certified: bool | None = None
    steps: Mapping[str, Sequence[int]] | None = None
    note: str | None = None

    def __post_init__(self) -> None:
        """Refuse options of another kind."""
        check_kind(self.origin, (Origin, NoneType), "origin", "an Origin or None")
        if self.altitude is not None and not is_number(self.altitude):
            raise ArgumentTypeError(
                f"altitude must be a number of meters or None, got {value_text(self.altitude)}"
            )
        check_kind(self.is_certified, (bool, NoneType), "is_certified", "True, False or None")
        check_kind(self.steps, (Mapping, NoneType), "steps", "a mapping of steps by name or None")
        check_kind(self.note, (str, NoneType), "note", "text or None")


@dataclass(frozen=True, slots=True)
class Exported:
    """What is to be written.

    Attributes
    ----------
    files : mapping
        Content per path.
    vehicles : mapping
        The vehicle's name per path, where every vehicle has a file of its own.
    warnings : tuple of str
        What the format loses.
    """

    files: Mapping[Path, bytes]
    vehicles: Mapping[Path, str]
    warnings: tuple[str, ...]


def export_plan(
    plan: Plan,
    to: str,
    path: str | os.PathLike[str],
    options: ExportOptions | None = None,
) -> Exported:
    """Return a plan in another format; nothing is written yet.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    to : str
        One of `FORMATS`.
    path : path
        The file. With several vehicles and a format of one vehicle each, their names are put
        before the ending.
    options : ExportOptions or None
        What the plan does not say.

    Returns
    -------
    Exported
        The same for the same plan and options.

    Raises
    ------
    NoPlanError
        If the plan has no trajectories.
    ScenarioError
        If the format is unknown, its arrays do not fit its scenario, an option does not fit, or
        the place on earth is missing.
    FileFormatError
        If the format's library is missing.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> [str(path) for path in radmpc.export_plan(plan, "csv", "fleet.csv").files]
    ['fleet.csv']
    """
    check_plan(plan)
    check_path(path)
    check_kind(options, (ExportOptions, NoneType), "options", "ExportOptions or None")
    options = options or ExportOptions()
    if not (isinstance(to, str) and to in FORMATS):
        raise ScenarioError(f"must be one of {', '.join(FORMATS)}, got {value_text(to)}", ("to",))
    job = _job(plan, to, options)
    target = Path(path)
    if to in _FLEET:
        return Exported({target: _FLEET[to](job)}, {}, _warnings(job, to))
    names = _file_names(job, target)
    files = {names[track.name]: _SINGLE[to](job, track) for track in job.tracks}
    vehicles = {place: name for name, place in names.items()} if len(files) > 1 else {}
    return Exported(files, vehicles, _warnings(job, to))


def save_export(
    plan: Plan,
    to: str,
    path: str | os.PathLike[str],
    options: ExportOptions | None = None,
) -> Exported:
    """Write a plan in another format; see `export_plan`.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    to : str
        One of `FORMATS`.
    path : path
        The file. With several vehicles and a format of one vehicle each, their names are put
        before the ending.
    options : ExportOptions or None
        What the plan does not say.

    Returns
    -------
    Exported
        The files written, and what the format loses.

    Raises
    ------
    NoPlanError
        If the plan has no trajectories.
    ScenarioError
        If the format is unknown, its arrays do not fit its scenario, an option does not fit, or
        the place on earth is missing.
    FileFormatError
        If the format's library is missing.
    OSError
        If a file cannot be written.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in radmpc.save_export(plan, "csv", Path(folder) / "a.csv").files]
    ['a.csv']
    """
    exported = export_plan(plan, to, path, options)
    save_exported(exported)
    return exported


def save_exported(exported: Exported) -> None:
    """Write every file, each whole or not at all.

    Parameters
    ----------
    exported : Exported
        As in `export_plan`.

    Raises
    ------
    ArgumentTypeError
        If it is something else.
    OSError
        If a file cannot be written.
    """
    check_kind(exported, Exported, "exported", "an Exported, as export_plan returns")
    for path, content in exported.files.items():
        write_bytes(path, content)


def _job(plan: Plan, to: str, options: ExportOptions) -> Job:
    """Return what the exporter gets, the options checked."""
    tracks = tracks_of(plan)
    if options.steps is not None:
        if to == "csv":
            raise ScenarioError("do not fit csv: its controls are for all steps", ("steps",))
        tracks = thinned_tracks(tracks, options.steps)
    if options.altitude is not None:
        if plan.scenario.dimension == 3:
            raise ScenarioError("is for 2-D plans: this one has heights of its own", ("altitude",))
        if to == "csv":
            raise ScenarioError("does not fit csv: it keeps the plan's coordinates", ("altitude",))
        if not abs(options.altitude) <= 1e5:
            raise ScenarioError(
                f"must lie between -100 and 100 km, got {options.altitude} m", ("altitude",)
            )
    altitude = 0.0 if options.altitude is None else options.altitude
    if options.origin is not None and to == "csv":
        raise ScenarioError("does not fit csv: it keeps the plan's coordinates", ("origin",))
    origin = options.origin
    if origin is None and to != "csv":
        try:
            origin = scenario_origin(plan.scenario)
        except ScenarioError as error:
            raise error.under("scenario") from error
    is_certified = options.is_certified
    if is_certified is None:
        certified = plan.risk.certified
        is_certified = certified is not None and certified <= plan.scenario.risk_bound
    placement = None if origin is None else Placement(origin, altitude)
    return Job(plan, tracks, is_certified, placement, altitude, options.note)


def _warnings(job: Job, to: str) -> tuple[str, ...]:
    """Return what a format loses of a plan."""
    warnings = [timing_sentence(job.plan)] if to in _SINGLE else []
    if to in _LEVEL:
        heights = height_sentence(job.place, [track.positions for track in job.tracks])
        warnings += [] if heights is None else [heights]
    return tuple(warnings)


def _file_names(job: Job, target: Path) -> dict[str, Path]:
    """Return the file of every vehicle."""
    names = [track.name for track in job.tracks]
    if len(names) == 1:
        return {names[0]: target}
    parts = distinct(names, file_part)
    return {
        name: target.with_name(f"{target.stem}.{part}{target.suffix}")
        for name, part in parts.items()
    }
