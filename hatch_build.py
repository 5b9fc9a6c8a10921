"""Puts the page of ``radmpc serve`` into wheels: built from web/ unless its bundle is fresh.

``RADMPC_PAGE=required`` fails where it cannot be built, ``RADMPC_PAGE=none`` leaves it out; else a
wheel without Node.js is one without the page, and says so.
"""

from __future__ import annotations

import os
import platform
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_MACHINES = {"x86_64", "amd64", "aarch64", "arm64"}
"""Processors that there are wheels of Node.js for; elsewhere an install must not wait for one."""


class PageHook(BuildHookInterface):  # type: ignore[type-arg]  # its parameter is hatchling's own
    """Builds the page before a wheel is packed."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return the wheel that brings Node.js, where nothing else does."""
        page = self._page()
        if page is None or page.is_fresh() or page.find_node():
            return []
        return [page.WHEEL] if platform.machine().lower() in _MACHINES else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Have the bundle made, and packed though git ignores it."""
        # Who works on the package builds the page by `make page`.
        if self.target_name != "wheel" or version == "editable":
            return
        wish = os.environ.get("RADMPC_PAGE", "")
        lack = "RADMPC_PAGE=none leaves it out" if wish == "none" else self._lack()
        if lack is None:
            build_data["artifacts"].append("src/radmpc/serving/bundle/**")
            return
        said = f"this wheel has no page for `radmpc serve`: {lack}"
        if wish == "required":
            raise RuntimeError(said)
        self.app.display_warning(said)

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
