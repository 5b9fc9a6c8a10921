"""Charts and other groups' problems as documents."""

from __future__ import annotations

from radmpc.errors import FileFormatError
from radmpc.importing import import_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.serving.work.control import Control

__all__ = ["read_chart"]


def read_chart(control: Control, path: str, name: str) -> dict[str, object]:
    """Return the document that a chart leads to; what was chosen for it stands in its source.

    Parameters
    ----------
    control : Control
        Told nothing: it takes a moment.
    path, name : str
        Where the chart is, and what the page calls it.

    Raises
    ------
    FileFormatError
        With one line that names file, line and field.
    """
    del control
    try:
        return encode_scenario(import_scenario(path).scenario)
    except FileFormatError as error:
        raise FileFormatError(str(error).replace(path, name)) from error
