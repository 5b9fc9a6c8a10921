"""The gallery: every example with its picture and its text; on the site its code is folded away.

An example is ``examples/NN_name.py``: the first line of its docstring is the title, the rest a
paragraph; ``main(out)`` writes ``out/NN_name.png`` (or .gif) and returns the number to be checked.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import io
import json
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError

from making import ROOT, code_digest, made

HEAD = """\
# Gallery

Small programs, each with its picture and one number that a test checks. They stand in
the folder `examples`, and each can be run by itself: `python examples/01_one_vehicle.py`.
"""
IMAGES = ROOT / "docs" / "images" / "gallery"
SUFFIXES = (".png", ".gif")
NUMBER = "number.json"


@dataclass(frozen=True)
class Example:
    """A script and what it says about itself.

    Attributes
    ----------
    path : Path
        The script.
    title : str
        First line of its docstring.
    text : str
        The rest of it.
    code : str
        The script without its docstring.
    """

    path: Path
    title: str
    text: str
    code: str


def examples(folder: Path = ROOT / "examples") -> list[Example]:
    """Return the examples of a folder in their order; none if there is no such folder."""
    return [read_example(path) for path in sorted(folder.glob("[0-9][0-9]_*.py"))]


def read_example(path: Path) -> Example:
    """Return an example.

    Parameters
    ----------
    path : Path
        The script.

    Returns
    -------
    Example
        Title, text and code.

    Raises
    ------
    PluginError
        If it has no docstring of a title and a paragraph.
    """
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source)
    title, _, text = (ast.get_docstring(tree) or "").partition("\n")
    if not title or not text.strip():
        raise PluginError(f"{path.name}: needs a docstring of a title and a paragraph")
    after = tree.body[0].end_lineno or 0
    code = "\n".join(source.splitlines()[after:]).strip("\n")
    return Example(path, title.rstrip("."), text.strip(), code)


def link(example: Example) -> str:
    """Return the line that leads to an example on a code host."""
    return f"[examples/{example.path.name}](../examples/{example.path.name})"


def section(example: Example, picture: str) -> str:
    """Return an example's part of the page: title, picture, text, and where its code is."""
    return (
        f"## {example.title}\n\n![{example.title}]({picture})\n\n{example.text}\n\n"
        f"{link(example)}\n"
    )


def page(of: list[Example]) -> str:
    """Return the gallery's page as it is committed, with the pictures that are."""
    names = {path.stem: path.name for path in IMAGES.iterdir()}
    parts = [section(e, f"images/gallery/{names[e.path.stem]}") for e in of]
    return "\n".join([HEAD, *parts])


def folded(example: Example) -> str:
    """Return an example's code, folded away."""
    code = "\n".join(f"    {line}".rstrip() for line in example.code.splitlines())
    return f'??? example "examples/{example.path.name}"\n\n    ```python\n{code}\n    ```'


def folder_of(example: Example) -> Path:
    """Return the folder of what an example wrote and returned; it is run if that is not there."""
    path = example.path
    return made(path.stem, code_digest(path), lambda out: _run(path, out))


def picture(example: Example) -> Path:
    """Return an example's picture, made if it is not there."""
    name = example.path.stem
    found = [folder_of(example) / f"{name}{suffix}" for suffix in SUFFIXES]
    there = [path for path in found if path.is_file()]
    if not there:
        raise PluginError(f"{example.path.name}: writes no {name}.png or .gif")
    return there[0]


def number(example: Example) -> Any:
    """Return what an example's main function returned."""
    return json.loads((folder_of(example) / NUMBER).read_text(encoding="utf-8"))


def _run(path: Path, out: Path) -> None:
    """Call an example's main function, keep its number; warnings are errors as in the tests."""
    import matplotlib as mpl  # noqa: PLC0415 - slow, and only needed where a picture is missing
    from matplotlib import pyplot  # noqa: PLC0415 - loads slowly

    mpl.use("Agg")
    spec = importlib.util.spec_from_file_location(f"example_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise PluginError(f"{path.name}: cannot be imported")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("error")
        number = module.main(out)
    pyplot.close("all")
    (out / NUMBER).write_text(json.dumps(number), encoding="utf-8")


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Put code in the place of links to it, on the gallery's page."""
    if page.file.src_uri == "gallery.md":
        for example in examples():
            markdown = markdown.replace(link(example), folded(example))
    return markdown
