"""Figures of the site, made by the build: the harbor, its ledger, and those of the examples.

In a page ``<!-- figure: ledger | Where the risk goes -->`` stands for the picture and its caption;
on a code host the comment is not seen. The name of an example stands for the example's picture.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

from making import ROOT, code_digest, made

MARK = re.compile(r"<!-- figure: (?P<name>[\w-]+) \| (?P<caption>[^>]+?) -->")


@cache
def _harbor() -> Any:
    """Return the plan of the shipped scenario."""
    import radmpc  # noqa: PLC0415 - only needed where a picture is missing

    scenario = radmpc.load_scenario(ROOT / "src" / "radmpc" / "data" / "harbor.yaml")
    return radmpc.plan(scenario, rng=0).require()


def _draw_harbor(path: Path) -> None:
    """Draw the plan."""
    from radmpc.plotting import save_figure  # noqa: PLC0415 - as above

    save_figure(_harbor(), path)


def _draw_ledger(path: Path) -> None:
    """Draw where its risk goes."""
    from radmpc.plotting import save_ledger  # noqa: PLC0415 - as above

    save_ledger(_harbor(), path)


def _draw_view(view: str, path: Path) -> None:
    """Draw what the function of that name shows of the plan."""
    from radmpc import plotting  # noqa: PLC0415 - as above

    plotting.save_axes(getattr(plotting, f"plot_{view}")(_harbor()), path)


def _film_harbor(path: Path) -> None:
    """Film the plan."""
    from radmpc.plotting import save_animation  # noqa: PLC0415 - as above

    save_animation(_harbor(), path)


FIGURES: dict[str, Callable[[Path], None]] = {
    "harbor.png": _draw_harbor,
    "ledger.png": _draw_ledger,
    "couplings.png": partial(_draw_view, "couplings"),
    "distances.png": partial(_draw_view, "distances"),
    "risk.png": partial(_draw_view, "risk"),
    "film.gif": _film_harbor,
}


def picture(name: str) -> Path:
    """Return the file of a figure, made if it is not there."""
    folder = made(
        Path(name).stem,
        code_digest(Path(__file__)),
        lambda unfinished: FIGURES[name](unfinished / name),
    )
    return folder / name


def on_files(files: Any, config: Any) -> Any:
    """Put the figures where pages show them; the harbor replaces the committed picture."""
    for name in FIGURES:
        uri = f"images/{name}"
        there = files.get_file_from_path(uri)
        if there is not None:
            files.remove(there)
        files.append(File.generated(config, uri, abs_src_path=str(picture(name))))
    return files


def on_page_markdown(markdown: str, page: Any, files: Any, **_: Any) -> str:
    """Show the figures that the page asks for."""
    folder = posixpath.dirname(page.file.src_uri) or "."

    def shown(match: re.Match[str]) -> str:
        name = match["name"]
        uris = [
            f"images/{name}.png",
            f"images/{name}.gif",
            f"images/gallery/{name}.png",
            f"images/gallery/{name}.gif",
        ]
        there = [uri for uri in uris if files.get_file_from_path(uri) is not None]
        if not there:
            raise PluginError(f"{page.file.src_uri}: no figure is called {name!r}")
        return f"![{match['caption']}]({posixpath.relpath(there[0], folder)})"

    return MARK.sub(shown, markdown)
