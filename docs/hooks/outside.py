"""Pages and files from outside docs/: CONTRIBUTING and CHANGELOG, and what pages link to.

Links are written for a code host, ``../CONTRIBUTING.md``; here they are turned to the site's.
"""

from __future__ import annotations

import posixpath
import re
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

from making import ROOT

PAGES = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Files of the repository that are pages of the site."""

STANDS_FOR = {**PAGES, "README.md": "index.md", "examples": "gallery.md"}
"""Where links to them lead."""

_LINK = re.compile(r"\]\((?![a-z]+:|#|/)(?P<path>[^)\s#]+)(?P<anchor>#[^)\s]*)?\)")


def site_uri(path: str) -> str:
    """Return where a file of the repository stands in the site.

    Parameters
    ----------
    path : str
        As seen from the repository's root.

    Returns
    -------
    str
        As seen from the site's root.
    """
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return STANDS_FOR.get(path, f"files/{path}")


def turned(markdown: str, path: str) -> str:
    """Return a page whose links lead to places in the site.

    Parameters
    ----------
    markdown : str
        The page, with links for a code host.
    path : str
        Where it stands in the repository.

    Returns
    -------
    str
        The page, with links for the site.
    """
    folder, here = posixpath.dirname(path), posixpath.dirname(site_uri(path)) or "."

    def link(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, match["path"]))
        uri = posixpath.relpath(site_uri(target), here)
        return f"]({uri}{match['anchor'] or ''})"

    return _LINK.sub(link, markdown)


def targets(markdown: str, path: str) -> set[str]:
    """Return the files outside docs/ that a page links to, seen from the root."""
    folder = posixpath.dirname(path)
    found = {
        posixpath.normpath(posixpath.join(folder, m["path"])) for m in _LINK.finditer(markdown)
    }
    return {name for name in found if site_uri(name).startswith("files/")}


def on_files(files: Any, config: Any) -> Any:
    """Add the pages, and the files that pages link to."""
    linked: set[str] = set()
    for page in files.documentation_pages():
        linked |= targets(page.content_string, f"docs/{page.src_uri}")
    for name, uri in PAGES.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        linked |= targets(text, name)
        files.append(File.generated(config, uri, content=turned(text, name)))
    for name in sorted(linked):
        if not (ROOT / name).is_file():
            raise PluginError(f"a page links to {name}, which is no file")
        uri = site_uri(name)
        files.append(File.generated(config, uri, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Turn the links of pages that stand in docs/."""
    if page.file.src_uri in PAGES.values():
        return markdown
    return turned(markdown, f"docs/{page.file.src_uri}")
