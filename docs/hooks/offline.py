"""The site loads nothing from elsewhere: whatever would is an error of the build."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError

_LOADED = re.compile(
    r"<(?:script|link|img|iframe|source|video|audio|object)\b[^>]*?"
    r"(?:src|href|data)=[\"']?(?P<address>(?:https?:)?//[^\s\"'>]+)",
    re.I,
)
_STYLED = re.compile(r"(?:url\(|@import\s)\s*[\"']?(?P<address>(?:https?:)?//[^\s\"')]+)", re.I)


def loaded(text: str) -> list[str]:
    """Return the addresses elsewhere from which a page or a style sheet loads something."""
    return [m["address"] for pattern in (_LOADED, _STYLED) for m in pattern.finditer(text)]


def on_post_build(config: Any, **_: Any) -> None:
    """Look through every page and style sheet."""
    site = Path(config["site_dir"])
    for path in sorted([*site.rglob("*.html"), *site.rglob("*.css")]):
        found = loaded(path.read_text(encoding="utf-8"))
        if found:
            raise PluginError(f"{path.relative_to(site)} loads from the network: {found[0]}")
