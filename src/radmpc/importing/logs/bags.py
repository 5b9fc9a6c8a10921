"""ROS 2 bags: MCAP files, and folders with MCAP or SQLite in them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from radmpc.errors import FileFormatError
from radmpc.importing.logs.flight_log import read_flight_log
from radmpc.importing.logs.mcap_file import open_mcap
from radmpc.importing.logs.recording import Recording, extra, refusal
from radmpc.importing.logs.ros import tracks_of
from radmpc.importing.logs.series import TYPES, Message

__all__ = ["read_bag", "read_mcap"]


def read_mcap(path: Path) -> Recording:
    """Return the vehicles of an MCAP file, with ROS 2 messages or of `radmpc fly`.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    FileFormatError
        If it cannot be read, or its libraries are missing.
    """
    extra("mcap_ros2.decoder", path)
    if not path.is_file():
        raise refusal(path, "No such file or directory")
    try:
        flight = read_flight_log(path)
        return tracks_of(path, _mcap_messages(path)) if flight is None else flight
    except FileFormatError:
        raise
    except Exception as error:  # the library raises whatever its parser stumbles on
        raise refusal(path, f"cannot be read as MCAP: {_reason(error)}") from error


def _mcap_messages(path: Path) -> Iterator[Message]:
    """Return an MCAP file's messages that are read here."""
    decoding = extra("mcap_ros2.decoder", path)
    with path.open("rb") as file:
        reader, kinds = open_mcap(path, file, [decoding.DecoderFactory()])
        topics = [topic for topic, kind in kinds.items() if kind in TYPES]
        if not topics:
            return
        for schema, channel, message, content in reader.iter_decoded_messages(topics=topics):
            if schema.name in TYPES:
                yield Message(channel.topic, schema.name, message.log_time, content)


def read_bag(path: Path) -> Recording:
    """Return the vehicles of a bag: a folder with ``metadata.yaml``, or a file ``.db3`` in it.

    Parameters
    ----------
    path : Path
        The folder or the file.

    Raises
    ------
    FileFormatError
        If it cannot be read, or its libraries are missing.
    """
    extra("rosbags", path)
    folder = path.parent if path.suffix == ".db3" else path
    if not path.exists():
        raise refusal(path, "No such file or directory")
    if not (folder / "metadata.yaml").is_file():
        raise refusal(path, "is no ROS 2 bag: there is no metadata.yaml in its folder")
    try:
        return tracks_of(path, _bag_messages(folder, path))
    except FileFormatError:
        raise
    except Exception as error:  # the library raises whatever its parser stumbles on
        raise refusal(path, f"cannot be read as a ROS 2 bag: {_reason(error)}") from error


def _bag_messages(folder: Path, path: Path) -> Iterator[Message]:
    """Return a bag's messages that are read here."""
    library, types = extra("rosbags.highlevel", path), extra("rosbags.typesys", path)
    # Bags of older releases do not say what their messages look like.
    usual = types.get_typestore(types.Stores.ROS2_HUMBLE)
    with library.AnyReader([folder], default_typestore=usual) as reader:
        chosen = [one for one in reader.connections if one.msgtype in TYPES]
        if not chosen:
            return
        for connection, log_time, raw in reader.messages(connections=chosen):
            content = reader.deserialize(raw, connection.msgtype)
            yield Message(connection.topic, connection.msgtype, log_time, content)


def _reason(error: Exception) -> str:
    """Return why a library could not go on."""
    return str(error) or type(error).__name__
