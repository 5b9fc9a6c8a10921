"""What an import says of a file that it does not take."""

from __future__ import annotations

from pathlib import Path

from radmpc.errors import FileFormatError
from radmpc.importing.formats import import_scenario

__all__ = ["refusal"]


def refusal(path: Path) -> str | None:
    try:
        import_scenario(path)
    except FileFormatError as error:
        return str(error)
    return None
