"""What examples make, kept in build/figures until the code that makes it changes."""

from __future__ import annotations

import hashlib
import logging
import shutil
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

__all__ = ["ROOT", "code_digest", "made"]

ROOT = Path(__file__).parent.parent.parent
CACHE = ROOT / "build" / "figures"

log = logging.getLogger("mkdocs.hooks.making")


def code_digest(*more: Path) -> str:
    """Return a name for the state of everything that pictures depend on.

    Parameters
    ----------
    *more : Path
        Files beside the package itself.

    Returns
    -------
    str
        Sixteen hexadecimal digits; they change with any of the files.
    """
    package = ROOT / "src" / "radmpc"
    files = sorted([*package.rglob("*.py"), *package.rglob("*.yaml"), Path(__file__), *more])
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.as_posix().encode() + b"\0" + path.read_bytes())
    for name in ("highspy", "matplotlib", "numpy", "pillow", "scipy", "shapely"):
        digest.update(version(name).encode())
    return digest.hexdigest()[:16]


def made(name: str, digest: str, make: Callable[[Path], None]) -> Path:
    """Return the folder of a picture, made now unless it is there already.

    Parameters
    ----------
    name : str
        The picture's name; older states of it are removed.
    digest : str
        The state it belongs to.
    make : callable
        Writes the picture into the folder that it is given.

    Returns
    -------
    Path
        The folder.
    """
    folder = CACHE / name / digest
    if folder.is_dir():
        return folder
    shutil.rmtree(CACHE / name, ignore_errors=True)
    # Under another name until it is whole: whoever is interrupted leaves nothing half done.
    unfinished = CACHE / name / "unfinished"
    unfinished.mkdir(parents=True)
    begun = time.perf_counter()
    make(unfinished)
    unfinished.rename(folder)
    log.info("made %s in %.1f s", name, time.perf_counter() - begun)
    return folder
