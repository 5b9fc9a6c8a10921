"""MCAP files opened, whatever of their summary was written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from radmpc.importing.logs.recording import extra, refusal

__all__ = ["open_mcap"]

_MAGIC = b"\x89MCAP0\r\n"
"""What a file begins and ends with."""


def open_mcap(
    path: Path, file: BinaryIO, decoders: Sequence[Any] = ()
) -> tuple[Any, Mapping[str, str]]:
    """Return a reader of an MCAP file, and the names of schemas by the topics that have one.

    Parameters
    ----------
    path : Path
        The file.
    file : binary file
        The same, open.
    decoders : sequence
        Factories of decoders for its messages.

    Raises
    ------
    FileFormatError
        If its end is missing, or the library is.
    """
    reading = extra("mcap.reader", path)
    _check_end(path, file)
    summary = reading.make_reader(file).get_summary()
    file.seek(0)
    if summary is not None and summary.channels:
        named = {key: schema.name for key, schema in summary.schemas.items()}
        kinds = {c.topic: named.get(c.schema_id, "") for c in summary.channels.values()}
        return reading.make_reader(file, decoder_factories=decoders), kinds
    # The summary need not repeat channels: then they stand among the messages alone.
    found = reading.NonSeekingReader(file).iter_messages(log_time_order=False)
    kinds = {channel.topic: schema.name for schema, channel, _ in found if schema is not None}
    file.seek(0)
    return reading.NonSeekingReader(file, decoder_factories=decoders), kinds


def _check_end(path: Path, file: BinaryIO) -> None:
    """Refuse a file that begins as MCAP does and ends otherwise."""
    begins = file.read(len(_MAGIC)) == _MAGIC
    size = file.seek(0, 2)
    file.seek(max(size - len(_MAGIC), 0))
    ends = file.read() == _MAGIC
    file.seek(0)
    if begins and not ends:
        raise refusal(
            path,
            "does not end as MCAP does: the recording was cut off, or something was added; "
            "'mcap recover' repairs it",
        )
