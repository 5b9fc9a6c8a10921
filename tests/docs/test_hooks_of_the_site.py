from __future__ import annotations

import importlib
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mkdocs.exceptions import PluginError
from pages import ROOT
from PIL import Image

IMAGES = ROOT / "docs" / "images"

EXAMPLE = '''\
"""A title.

What it shows.
"""

from pathlib import Path

EXPECTED = 1.0


def main(out: Path) -> float:
    print("words that the build does not want")
    (out / "01_first.png").write_bytes(b"a picture")
    return EXPECTED
'''


@pytest.fixture
def hook(hooks: None):
    return importlib.import_module


@pytest.fixture
def cache(hook, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Keep pictures made here apart from those of the site."""
    monkeypatch.setattr(hook("making"), "CACHE", tmp_path)
    return tmp_path


@pytest.fixture
def example(tmp_path: Path) -> Path:
    path = tmp_path / "01_first.py"
    path.write_text(EXAMPLE, encoding="utf-8")
    return path


def test_links_are_turned_from_the_repository_to_the_site(hook) -> None:
    turned = hook("outside").turned
    assert turned("[a](docs/floors.md#why)", "CONTRIBUTING.md") == "[a](floors.md#why)"
    assert turned("[a](../CONTRIBUTING.md)", "docs/index.md") == "[a](contributing.md)"
    assert turned("[a](../../README.md)", "docs/reference/index.md") == "[a](../index.md)"
    assert turned("[a](../examples)", "docs/gallery.md") == "[a](gallery.md)"
    assert turned("[a](../b/c.gz)", "docs/paper.md") == "[a](files/b/c.gz)"


def test_links_within_docs_and_to_elsewhere_stay(hook) -> None:
    for link in ("problem.md#cost", "#cost", "https://example.org/a.md", "images/harbor.png"):
        assert hook("outside").turned(f"[a]({link})", "docs/index.md") == f"[a]({link})"


def test_files_that_pages_link_to_become_part_of_the_site(hook) -> None:
    page = "[rows](../benchmarks/data/rows.gz) [a](problem.md) [b](../README.md)"
    assert hook("outside").targets(page, "docs/paper.md") == {"benchmarks/data/rows.gz"}


def test_without_examples_the_gallery_is_empty(hook, tmp_path: Path) -> None:
    assert hook("gallery").examples(tmp_path / "nowhere") == []


def test_an_example_is_its_title_text_and_code(hook, example: Path) -> None:
    (found,) = hook("gallery").examples(example.parent)
    assert (found.title, found.text) == ("A title", "What it shows.")
    assert found.code.startswith("from pathlib")
    text = hook("gallery").section(found, "a.png")
    assert text.startswith("## A title\n\n![A title](a.png)\n\nWhat it shows.")
    assert "\n    def main(out: Path) -> float:\n" in hook("gallery").folded(found)


def test_an_example_without_a_text_is_refused(hook, example: Path) -> None:
    example.write_text('"""Only a title."""\n', encoding="utf-8")
    with pytest.raises(PluginError, match=r"01_first\.py: needs a docstring"):
        hook("gallery").examples(example.parent)


def test_an_example_is_run_once_and_in_silence(
    hook, cache: Path, example: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (found,) = hook("gallery").examples(example.parent)
    picture = hook("gallery").picture(found)
    assert picture.read_bytes() == b"a picture"
    picture.write_bytes(b"kept")
    assert hook("gallery").picture(found).read_bytes() == b"kept"
    assert capsys.readouterr().out == ""


def test_an_example_that_draws_nothing_is_refused(hook, cache: Path, example: Path) -> None:
    example.write_text(EXAMPLE.replace("01_first", "other"), encoding="utf-8")
    (found,) = hook("gallery").examples(example.parent)
    with pytest.raises(PluginError, match="writes no 01_first"):
        hook("gallery").picture(found)


def test_a_picture_is_made_anew_when_its_code_changes(hook, cache: Path) -> None:
    made, calls = hook("making").made, []
    for digest in ("old", "old", "new"):
        assert made("name", digest, calls.append) == cache / "name" / digest
    assert len(calls) == 2
    assert [path.name for path in (cache / "name").iterdir()] == ["new"]


def test_a_picture_that_failed_is_not_kept(hook, cache: Path) -> None:
    def fail(folder: Path) -> None:
        (folder / "half.png").touch()
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        hook("making").made("name", "digest", fail)
    assert not (cache / "name" / "digest").exists()


def test_every_committed_picture_is_one_that_is_made_anew_and_is_small(hook) -> None:
    stems = {example.path.stem for example in hook("gallery").examples()}
    assert {path.name for path in IMAGES.iterdir() if path.is_file()} == set(
        hook("figures").FIGURES
    )
    assert {path.stem for path in (IMAGES / "gallery").iterdir()} == stems
    assert {path.name for path in (IMAGES / "page").iterdir()} == set(hook("screens").SCREENS)
    folders = (IMAGES, IMAGES / "gallery", IMAGES / "page")
    pictures = [path for folder in folders for path in folder.glob("*.*")]
    assert max(path.stat().st_size for path in pictures) < 150_000
    assert sum(path.stat().st_size for path in pictures) < 60_000 * len(pictures)


def test_the_gallery_is_what_the_examples_say_of_themselves(hook) -> None:
    gallery = hook("gallery")
    committed = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert committed == gallery.page(gallery.examples()), "make pictures"


def test_the_site_folds_code_where_a_code_host_has_links(hook) -> None:
    gallery = hook("gallery")
    shown = gallery.on_page_markdown(
        (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8"),
        page=SimpleNamespace(file=SimpleNamespace(src_uri="gallery.md")),
    )
    assert shown.count("??? example") == len(gallery.examples())
    assert "](../examples/" not in shown


def test_small_pictures_keep_shape_white_paper_and_length(hook, tmp_path: Path) -> None:
    frames = [Image.new("RGB", (840, 400), "white") for _ in range(4)]
    for number, frame in enumerate(frames):
        frame.paste((200, 30, 30), (100 * number, 50, 100 * number + 80, 200))
    frames[0].save(tmp_path / "a.gif", save_all=True, append_images=frames[1:], duration=100)
    frames[0].resize((2100, 1000)).save(tmp_path / "a.png")
    for name in ("a.gif", "a.png"):
        hook("figures").write_small(tmp_path / name, tmp_path / f"small-{name}")
    with Image.open(tmp_path / "small-a.gif") as film:
        assert (film.size, film.n_frames, film.info["duration"]) == ((420, 200), 2, 200)
        assert film.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
    with Image.open(tmp_path / "small-a.png") as picture:
        assert picture.size == (1150, 548)


def test_colors_of_vehicles_stay_apart_in_small_films(hook, tmp_path: Path) -> None:
    blue, green, orange = (0, 114, 178), (0, 158, 115), (213, 94, 0)
    frame = Image.new("RGB", (420, 400), "white")
    shades = range(50, 250, 2)  # as where texts and lines are smoothed
    for place, shade in enumerate(shades):
        frame.paste((shade, shade, shade), (4 * place, 0, 4 * place + 4, 300))
    for row, color in enumerate((blue, green, orange)):
        frame.paste(color, (0, 310 + 20 * row, 3, 313 + 20 * row))
    frame.save(tmp_path / "a.gif", save_all=True, append_images=[frame.copy()], duration=100)
    hook("figures").write_small(tmp_path / "a.gif", tmp_path / "small.gif")
    with Image.open(tmp_path / "small.gif") as film:
        small = film.convert("RGB")
        shown = [small.getpixel((1, 311 + 20 * row)) for row in range(3)]
    assert np.abs(np.array(shown) - np.array([blue, green, orange])).max() < 16


def test_the_search_needs_no_server() -> None:
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert "\n  - offline" in settings
    (script,) = re.findall(r"polyfills:\n    - (\S+)", settings)
    assert "iframe-worker" in script  # else the plugin adds one from the network
    assert (ROOT / "docs" / script).is_file()


def test_formulas_become_mathml(hook) -> None:
    page = '<p><span class="arithmatex">\\(\\bar p \\sim \\mathcal N(0, 1)\\)</span></p>'
    drawn = hook("mathematics").on_page_content(page)
    assert drawn.startswith("<p><math ")
    assert "\N{COMBINING MACRON}</mi>" in drawn
    assert "<mo>&#x0223C;</mo>" in drawn
    assert "\N{MATHEMATICAL SCRIPT CAPITAL N}" in drawn
    assert 'display="block"' in hook("mathematics").formula("a &lt; b", "block")


def test_the_bars_of_a_norm_are_equally_high(hook) -> None:
    drawn = hook("mathematics").formula(r"\sum_k \lVert \bar u_i^k \rVert_1", "block")
    bars = re.findall(r"<mo([^>]*)>&#x02016;</mo>", drawn)
    assert bars == [' stretchy="false" form="prefix"', ' stretchy="false" form="postfix"']


def test_formulas_of_docstrings_become_those_of_pages(hook) -> None:
    text = "Of :math:`x`:\n\n    .. math:: a\n        + b\n\n    End."
    assert hook("docstrings").as_markdown(text) == "Of $x$:\n\n    $$a + b$$\n\n    End."


def test_whatever_a_page_loads_from_elsewhere_is_found(hook) -> None:
    loaded = hook("offline").loaded
    assert loaded('<script src="https://cdn.test/a.js">') == ["https://cdn.test/a.js"]
    assert loaded("@import url('//fonts.test/a.css')") == ["//fonts.test/a.css"]
    assert loaded('<a href="https://example.org">read on</a><img src="a.png">') == []


def test_the_site_is_built_strictly_by_make_check() -> None:
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert "\nstrict: true\n" in settings
    assert settings.count(": warn\n") == 4
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (check,) = re.findall(r"^check:.*\n((?:\t.*\n)+)", makefile, re.M)
    (docs,) = re.findall(r"^docs:.*\n((?:\t.*\n)+)", makefile, re.M)
    made = {word for words in re.findall(r"\$\(MAKE\) (.*)", check) for word in words.split()}
    assert {"format", "lint", "floors", "types", "docs", "test"} <= made
    assert "mkdocs build" in docs
