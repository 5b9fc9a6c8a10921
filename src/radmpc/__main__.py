"""Run the command line with ``python -m radmpc``: Ctrl-C at any time is one line."""

from __future__ import annotations

import gc
import os
import signal
from types import FrameType

from radmpc.system.streams import settle_streams

__all__ = ["main"]

_INTERRUPTED = 1
"""Exit code while modules still load; commands have the shell's 130."""

_COLLECTED_AFTER = 200_000
"""Objects after which Python looks for dead circles among the new ones [-], instead of 700: what is
loaded stays, 110,000 of them for `plan`, and planning leaves hardly any. The peak of memory is the
same as with 20,000: 84 MB for two vehicles, 107 MB for thirty of `fleet`. To look through them once
takes a twentieth of the time of `plan` for two vehicles, and longer on a busy machine."""


def main() -> None:
    """Run the command line and exit the process with its code."""
    settle_streams()
    gc.set_threshold(_COLLECTED_AFTER)
    # It would look for them in every package that is installed.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")
    # While modules load, an exception would come out of any of them with a traceback.
    usual = signal.getsignal(signal.SIGINT)
    if usual is not signal.SIG_IGN:  # as in a background job
        signal.signal(signal.SIGINT, _leave)
    from radmpc.cli import app  # noqa: PLC0415 - guarded while it loads

    signal.signal(signal.SIGINT, usual)
    code = _INTERRUPTED
    try:
        code = app(standalone_mode=False)
    except KeyboardInterrupt:
        os.write(2, b"radmpc: interrupted\n")
    # What is left is the interpreter's own end; it would end by SIGINT rather than with the code
    # if the last string that anything executed had been interrupted.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    exec("")
    # The interpreter looks for dead circles once more before it ends, among all there is.
    gc.freeze()
    raise SystemExit(code)


def _leave(signum: int, frame: FrameType | None) -> None:
    """End the process; nothing has been begun."""
    del signum, frame
    os.write(2, b"radmpc: interrupted\n")
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    main()
