"""Problems of other groups, whatever their format."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.document import Document, read_document
from radmpc.io.dynobench import is_dynobench, read_dynobench
from radmpc.io.foreign import ForeignProblem
from radmpc.io.import_options import ImportOptions
from radmpc.io.lsc import is_lsc, read_lsc
from radmpc.io.overlay import ImportedScenario, overlay
from radmpc.io.schema import SCENARIO_FORMAT
from radmpc.io.text import one_line

__all__ = ["ImportOptions", "ImportedScenario", "import_scenario"]


@dataclass(frozen=True, slots=True)
class _Importer:
    """A format: what it is called, how it is recognized, how it is read."""

    name: str
    recognizes: Callable[[object], bool]
    read: Callable[[Document], ForeignProblem]


_IMPORTERS = (
    _Importer("dynobench", is_dynobench, read_dynobench),
    _Importer("LSC", is_lsc, read_lsc),
)


def import_scenario(
    path: str | os.PathLike[str], options: ImportOptions | None = None
) -> ImportedScenario:
    """Return a scenario of a problem that another group published.

    Parameters
    ----------
    path : path
        The problem; its format is recognized by its content.
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
    """
    document = read_document(path)
    for importer in _IMPORTERS:
        if importer.recognizes(document.value):
            try:
                return overlay(importer.read(document), options or ImportOptions())
            except ScenarioError as error:
                raise document.failure(error) from error
    if isinstance(document.value, Mapping) and document.value.get("format") == SCENARIO_FORMAT:
        raise FileFormatError(one_line(f"{document.name}: is a scenario already"))
    known = ", ".join(importer.name for importer in _IMPORTERS)
    raise FileFormatError(one_line(f"{document.name}: is of no format known here ({known})"))
