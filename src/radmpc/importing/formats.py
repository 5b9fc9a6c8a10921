"""Problems of other groups, whatever their format."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import NoneType
from typing import Any

from radmpc.arguments import check_kind, check_path
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.geodesy import Origin
from radmpc.importing.completion import ImportedScenario, overlay
from radmpc.importing.dynobench import is_dynobench, read_dynobench
from radmpc.importing.geo.charts import is_chart, read_charts, read_ground
from radmpc.importing.geo.geojson import geojson_document
from radmpc.importing.geo.ground import Ground
from radmpc.importing.geo.kml import kml_document, kmz_refusal
from radmpc.importing.grid.movingai import is_movingai, map_refusal, read_movingai, scen_document
from radmpc.importing.grid.problem import is_multi_robot_grid, read_multi_robot_grid
from radmpc.importing.lsc import is_lsc, read_lsc
from radmpc.importing.options import ImportOptions
from radmpc.importing.outputs import content_text, name_text
from radmpc.importing.problem import ForeignProblem
from radmpc.importing.s2m2 import is_s2m2, read_s2m2
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.text.document import Document, read_document
from radmpc.io.text.files import one_line
from radmpc.io.text.yaml_text import NOT_YAML
from radmpc.records import dataclass

__all__ = ["ImportedScenario", "import_ground", "import_scenario"]


@dataclass(frozen=True, slots=True)
class _Importer:
    """A format: what it is called, how it is recognized, how it is read."""

    name: str
    recognizes: Callable[[object], bool]
    read: Callable[[Document], ForeignProblem]


_IMPORTERS = (
    _Importer("dynobench", is_dynobench, read_dynobench),
    _Importer("LSC", is_lsc, read_lsc),
    _Importer("s2m2", is_s2m2, read_s2m2),
    _Importer("libMultiRobotPlanning", is_multi_robot_grid, read_multi_robot_grid),
    _Importer("MovingAI", is_movingai, read_movingai),
)
_READERS: Mapping[str, Callable[[str | os.PathLike[str]], Document]] = {
    ".scen": scen_document,
    ".geojson": geojson_document,
    ".kml": kml_document,
}
_REFUSALS: Mapping[str, Callable[[str | os.PathLike[str]], FileFormatError]] = {
    ".map": map_refusal,
    ".kmz": kmz_refusal,
}

_MOST_BYTES = 8 * 2**20
"""Size of a file that is imported [bytes]."""


def import_scenario(
    path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    options: ImportOptions | None = None,
) -> ImportedScenario:
    """Return a scenario of a problem that another group published.

    Parameters
    ----------
    path : path or sequence of paths
        The problem; its format is recognized by its content, of files in formats of their own
        (``.scen``, ``.geojson``, ``.kml``) by their ending. Several are charts of one problem.
    options : ImportOptions or None
        What is not to be chosen by the importer.

    Returns
    -------
    ImportedScenario
        With every choice and its reason.

    Raises
    ------
    FileFormatError
        If no importer knows the format, or with one line that names file, line and field.
    ArgumentTypeError
        If an argument is of another kind; the message says what to do instead.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> cells = "map: {dimensions: [4, 3], obstacles: [[1, 1]]}"
    >>> agent = "agents: [{name: a, start: [0, 0], goal: [3, 2]}]"
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.yaml"
    ...     _ = path.write_text("{" + cells + ", " + agent + "}")
    ...     radmpc.import_scenario(path).scenario
    Scenario('map', 1 vehicle, 1 obstacle, 10 steps of 0.54 s, risk bound 0.05)
    """
    paths: list[Any] = list(path) if isinstance(path, list | tuple) else [path]
    for one in paths or [path]:
        check_path(one)
    check_kind(options, (ImportOptions, NoneType), "options", "ImportOptions or None")
    options = options or ImportOptions()
    documents = [_read(one) for one in paths]
    if all(is_chart(document.value) for document in documents):
        return _of_charts(documents, options)
    if len(documents) > 1:
        other = next(one for one in documents if not is_chart(one.value))
        text = "is no chart (GeoJSON, KML): only these are imported several at once"
        raise FileFormatError(one_line(f"{other.name}: {text}"))
    return _of_problem(documents[0], options)


def import_ground(path: str | os.PathLike[str], origin: Origin | None = None) -> Ground | None:
    """Return what stands on a chart, even if no vehicle starts there.

    Parameters
    ----------
    path : path
        As in `import_scenario`, one of it.
    origin : Origin or None
        Of the plane that it is drawn in; None leaves that to the chart.

    Returns
    -------
    Ground or None
        None of what is no chart.

    Raises
    ------
    FileFormatError
        With one line that names file, line and field.
    """
    document = _read(path)
    if not is_chart(document.value):
        return None
    try:
        return read_ground(document, origin)
    except ScenarioError as error:
        raise document.failure(error) from error


def _of_charts(documents: Sequence[Document], options: ImportOptions) -> ImportedScenario:
    """Return the scenario of charts, with errors named by file and line."""
    try:
        imported = overlay(read_charts(documents, options.layer), options)
    except ScenarioError as error:
        if error.path and isinstance(error.path[0], int):
            inner = ScenarioError(error.message, error.path[1:])
            raise documents[error.path[0]].failure(inner) from error
        if len(documents) == 1:
            raise documents[0].failure(error) from error
        raise FileFormatError(one_line(f"{_names(documents)}: {error}")) from error
    _check_readable(imported, _names(documents))
    return imported


def _names(documents: Sequence[Document]) -> str:
    """Return the names of several files for a message."""
    return ", ".join(document.name for document in documents)


def _of_problem(document: Document, options: ImportOptions) -> ImportedScenario:
    """Return the scenario of a problem in a single file."""
    if options.layer:
        raise ScenarioError("is for charts, GeoJSON and KML", ("layer",))
    for importer in _IMPORTERS:
        if importer.recognizes(document.value):
            try:
                imported = overlay(importer.read(document), options)
            except ScenarioError as error:
                raise document.failure(error) from error
            _check_readable(imported, document.name)
            return imported
    raise _unknown(document.name, document.value)


def _unknown(name: str, value: object = None) -> FileFormatError:
    """Return the error of a file that no importer knows."""
    told = content_text(value) or name_text(name)
    if told is not None:
        return FileFormatError(one_line(f"{name}: {told}"))
    known = ", ".join([*(importer.name for importer in _IMPORTERS), "GeoJSON", "KML"])
    return FileFormatError(one_line(f"{name}: is of no format known here ({known})"))


def _check_readable(imported: ImportedScenario, name: str) -> None:
    """Refuse a scenario whose own file would be refused: its numbers are too large."""
    try:
        decode_scenario(encode_scenario(imported.scenario))
    except ScenarioError as error:
        raise FileFormatError(
            one_line(f"{name}: leads to a scenario that cannot be: {error}")
        ) from error


def _read(path: str | os.PathLike[str]) -> Document:
    """Return what a file holds, read by its ending."""
    suffix = Path(path).suffix.lower()
    if suffix in _REFUSALS:
        raise _REFUSALS[suffix](path)
    try:
        size = Path(path).stat().st_size
    except (OSError, ValueError):
        size = 0  # reading it tells what is wrong
    if size > _MOST_BYTES:
        much = f"must be at most {_MOST_BYTES // 2**20} MiB, got {size / 2**20:.0f}"
        raise FileFormatError(one_line(f"{os.fspath(path)}: {name_text(path) or much}"))
    try:
        return _READERS.get(suffix, read_document)(path)
    except FileFormatError as error:
        # Where a file that is not called YAML is none, its errors are not reported.
        is_other = NOT_YAML in str(error) and suffix not in {".yaml", ".yml"}
        if is_other or name_text(path) is not None:
            raise _unknown(os.fspath(path)) from error
        raise
