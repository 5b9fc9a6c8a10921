from __future__ import annotations

import ast
import importlib
import importlib.util
import re
import runpy
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from pages import ROOT
from PIL import Image

FOLDER = ROOT / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
MOST_LINES = 59
LEAST_PIXELS = 400
MOST_CHANGE = 3.0  # of 255 gray levels: what is made anew has up to 0.6, other looks 4 and more


def loaded(path: Path) -> ModuleType:
    """The example as a module, without running it."""
    spec = importlib.util.spec_from_file_location(f"example_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def glimpse(path: Path) -> np.ndarray:
    """What a picture, or a film's first frame, looks like from afar."""
    with Image.open(path) as image:
        return np.asarray(image.convert("L").resize((48, 48)), dtype=float)


@pytest.fixture(params=EXAMPLES, ids=lambda path: path.stem)
def example(request: pytest.FixtureRequest) -> Path:
    return request.param


def test_there_are_fifteen_examples_in_order():
    assert [path.name[:3] for path in EXAMPLES] == [f"{n:02}_" for n in range(1, 16)]


def test_every_example_is_short(example):
    assert len(example.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_every_example_has_a_title_and_a_paragraph(example):
    text = ast.get_docstring(ast.parse(example.read_text(encoding="utf-8")))
    title, blank, *paragraph = (text or "").splitlines()
    assert re.fullmatch(r"[A-Z].+\.", title)
    assert blank == ""
    assert len(paragraph) >= 2
    assert "" not in paragraph


def test_no_example_imports_a_private_name_or_another_example(example):
    tree = ast.parse(example.read_text(encoding="utf-8"))
    modules = {n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    names = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    parts = {part for name in modules | names for part in name.split(".")}
    assert not any(part.startswith("_") and part != "__future__" for part in parts)
    assert not parts & {path.stem for path in EXAMPLES}


@pytest.mark.slow
@pytest.mark.sampled(1)
def test_every_example_gives_its_number_and_its_picture(example, hooks):
    gallery = importlib.import_module("gallery")
    made = gallery.read_example(example)
    module, number = loaded(example), gallery.number(made)
    assert isinstance(number, float)
    assert number == pytest.approx(module.EXPECTED, rel=0.0, abs=module.TOLERANCE)
    (picture,) = gallery.folder_of(made).glob(f"{example.stem}.*")
    assert picture == gallery.picture(made)
    with Image.open(picture) as image:
        image.load()
        assert min(image.size) >= LEAST_PIXELS
        is_film = getattr(image, "n_frames", 1) > 1
    assert picture.suffix == (".gif" if is_film else ".png")
    difference = np.abs(glimpse(picture) - glimpse(gallery.IMAGES / picture.name)).mean()
    assert difference < MOST_CHANGE, "the committed picture is another one: make pictures"


def test_an_example_run_as_a_program_prints_its_number(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLES[0]), run_name="__main__")
    assert re.fullmatch(r"effort \[m/s²\]: [23]\.\d+\n", capsys.readouterr().out)
    assert (tmp_path / "01_one_vehicle.png").is_file()


def test_the_readme_states_the_number_of_every_example():
    table = (FOLDER / "README.md").read_text(encoding="utf-8")
    stated = dict(re.findall(r"^\| \[(\S+)\]\(\S+\) (?:\|[^|\n]+){2}\| ([\d.]+)", table, re.M))
    for path in EXAMPLES:
        number = stated[path.name]
        half_digit = 0.5 * 10.0 ** -len(number.partition(".")[2])
        assert abs(float(number) - loaded(path).EXPECTED) <= half_digit + 1e-9, path.name


def test_the_readme_lists_every_example():
    table = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| \[(\S+)\]\(\1\)", table, re.M) == [path.name for path in EXAMPLES]
