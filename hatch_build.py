"""Puts into the package what is not Python: the compiled simplex method and the page.

``RADMPC_COMPILED=required`` fails where the compiler does, ``RADMPC_COMPILED=none`` leaves compiled
code out: HiGHS then solves what it would have. ``RADMPC_PAGE`` does the same for the page of
``radmpc serve``, which is built from web/ unless its bundle is fresh. Else a wheel without a
compiler or Node.js is one without these parts, and says so.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_MACHINES = {"x86_64", "amd64", "aarch64", "arm64"}
"""Processors that there are wheels of Node.js for; elsewhere an install must not wait for one."""

_SOLVERS = Path("src/radmpc/solvers")
_COMPILED = _SOLVERS / "_compiled.abi3.so"
"""Of Python's stable interface: one for all versions from 3.11 on."""

_FLAGS = ("-std=gnu11", "-O3", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
"""Products are rounded before they are added, so that every processor finds the same vertices."""


class BuildHook(BuildHookInterface):  # type: ignore[type-arg]  # its parameter is hatchling's own
    """Compiles, and builds the page before a wheel is packed."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return the wheel that brings Node.js, where nothing else does."""
        page = self._page()
        if page is None or page.is_fresh() or page.find_node():
            return []
        return [page.WHEEL] if platform.machine().lower() in _MACHINES else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Have both made, and packed though git ignores them."""
        if self.target_name != "wheel":
            return
        folder = Path(self.root) / _SOLVERS / "compiled"
        lack = "no compiled simplex method, HiGHS solves all linear programs"
        if folder.is_dir() and self._has("COMPILED", lack, self._compile):
            build_data["artifacts"].append(str(_COMPILED))
            build_data["pure_python"] = False
            place = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            build_data["tag"] = f"cp311-abi3-{place}"
        # Who works on the package builds the page by `make page`.
        lack = "this wheel has no page for `radmpc serve`"
        if version != "editable" and self._has("PAGE", lack, self._lack):
            build_data["artifacts"].append("src/radmpc/serving/bundle/**")

    def _has(self, part: str, without: str, make: Callable[[], str | None]) -> bool:
        """Make a part; say what the package is without it where that is not possible."""
        wish = os.environ.get(f"RADMPC_{part}", "")
        why = f"RADMPC_{part}=none leaves it out" if wish == "none" else make()
        if why is None:
            return True
        said = f"{without}: {why}"
        if wish == "required":
            raise RuntimeError(said)
        self.app.display_warning(said)
        return False

    def _compile(self) -> str | None:
        """Compile what is newer than its result; return why that is not possible."""
        root = Path(self.root)
        target, folder = root / _COMPILED, root / _SOLVERS / "compiled"
        sources = sorted(folder.glob("*.c"))
        newest = max(path.stat().st_mtime for path in (*sources, *folder.glob("*.h")))
        if target.is_file() and target.stat().st_mtime > newest:
            return None
        if sys.platform != "linux":
            return f"it is compiled on Linux only, not on {sys.platform}"
        compiler = os.environ.get("CC") or "cc"
        made = target.with_suffix(f".{os.getpid()}")
        include = f"-I{sysconfig.get_path('include')}"
        command = [*compiler.split(), *_FLAGS, include, *map(str, sources), "-o", str(made), "-lm"]
        try:
            subprocess.run(command, check=True, capture_output=True, text=True)
        except OSError as error:
            return f"{compiler}: {error.strerror or error}"
        except subprocess.CalledProcessError as error:
            made.unlink(missing_ok=True)
            said = error.stderr.strip() or f"exit code {error.returncode}"
            return f"{compiler} failed: {said.splitlines()[0]}"
        made.replace(target)
        return None

    def _lack(self) -> str | None:
        """Return why there is no fresh bundle; None where there is one now."""
        page = self._page()
        if page is None:
            return "web/ is not here"
        if page.is_fresh():
            return None
        node = page.find_node()
        if node is None:
            return f"no Node.js here (pip install {page.WHEEL})"
        try:
            page.build(node)
        except page.PageError as error:
            return str(error)
        return None

    def _page(self) -> ModuleType | None:
        """Return web/page.py as a module."""
        web = Path(self.root) / "web"
        if not (web / "package-lock.json").is_file():
            return None
        sys.path.insert(0, str(web))
        try:
            import page  # noqa: PLC0415 - no package: it stands beside what it builds
        finally:
            sys.path.remove(str(web))
        return page
