"""The page's view in notebooks, as Python has it; `tests/page` looks at it in a browser."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from types import SimpleNamespace

import pytest

import radmpc
from radmpc.errors import ArgumentError, ArgumentTypeError
from radmpc.experiments.families import paper
from radmpc.viewing import bundle as bundles
from radmpc.viewing.content import view_content
from radmpc.viewing.showing import show_in_notebooks


@pytest.fixture(scope="module")
def result() -> radmpc.Result:
    return radmpc.plan(paper(2, 1), "multi-vehicle", rng=0)


@pytest.fixture
def bundle(tmp_path, monkeypatch):
    """A folder like that of a page that was built."""
    for name, text in {"widget.js": "code", "widget.css": "style", "space.js": "space"}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(bundles, "BUNDLE", tmp_path)
    return tmp_path


def test_a_result_its_plan_and_its_scenario_have_the_same_map(result):
    contents = [view_content(value) for value in (result, result.plan, result.plan.scenario)]
    assert contents[0] == contents[1]
    assert contents[0]["scenario"] == contents[2]["scenario"]
    assert contents[2]["plan"] is None
    assert [track["name"] for track in contents[0]["plan"]["tracks"]] == ["v1", "v2"]
    assert json.loads(json.dumps(contents[0], allow_nan=False))["plan"]["perStep"] == 4


def test_there_is_no_view_of_a_number():
    with pytest.raises(ArgumentTypeError, match="must be a Result, a Plan or a Scenario, got int"):
        radmpc.view(3)


def test_without_the_extra_the_view_says_what_to_install(bundle, monkeypatch):
    monkeypatch.setattr(bundles, "find_spec", lambda name: None)
    with pytest.raises(ArgumentError, match=re.escape("pip install 'radmpc[notebook]'")):
        radmpc.view(paper(2, 1))


def test_a_checkout_without_the_page_says_how_to_build_it(tmp_path, monkeypatch):
    pytest.importorskip("anywidget")
    monkeypatch.setattr(bundles, "BUNDLE", tmp_path / "none")
    with pytest.raises(ArgumentError, match="which this installation lacks: make page"):
        radmpc.view(paper(2, 1))


def test_the_widget_brings_the_page_and_the_value(bundle, result):
    pytest.importorskip("anywidget")
    made = radmpc.view(result)
    assert (made._esm, made._style) == ("code", "style")
    assert made.content == view_content(result)
    made.time = 2.5
    assert made.get_state("time") == {"time": 2.5}


def test_the_view_in_space_comes_when_it_is_asked_for(bundle, result, monkeypatch):
    pytest.importorskip("anywidget")
    made, sent = radmpc.view(result), []
    monkeypatch.setattr(made, "send", lambda content, buffers: sent.append((content, buffers)))
    made._handle_custom_msg({"ask": "the time"}, [])
    assert sent == []
    made._handle_custom_msg({"ask": "space"}, [])
    assert sent == [({"answer": "space"}, [b"space"])]


@pytest.fixture
def formatter(monkeypatch):
    """What a notebook shows values by, with ours registered."""
    formatters = pytest.importorskip("IPython.core.formatters")
    shell = SimpleNamespace(kernel=object(), display_formatter=formatters.DisplayFormatter())
    monkeypatch.setitem(
        sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell, version_info=(9, 0))
    )
    show_in_notebooks()
    return shell.display_formatter


@pytest.mark.slow
def test_a_notebook_shows_the_view_and_for_pages_without_widgets_the_picture(
    formatter, bundle, result
):
    data, _ = formatter.format(result)
    assert "model_id" in data["application/vnd.jupyter.widget-view+json"]
    assert data["text/html"] == result._repr_html_()
    assert data["text/plain"] == repr(result)


def test_a_notebook_without_the_page_shows_what_it_showed(formatter, tmp_path, monkeypatch):
    monkeypatch.setattr(bundles, "BUNDLE", tmp_path / "none")
    scenario = paper(2, 1)
    data, _ = formatter.format(scenario)
    assert "application/vnd.jupyter.widget-view+json" not in data
    assert data["text/html"] == scenario._repr_html_()


def test_a_terminal_has_no_place_for_a_view(monkeypatch):
    shell = SimpleNamespace(display_formatter=None)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    show_in_notebooks()


def test_programs_outside_of_notebooks_load_nothing_of_it():
    program = "import sys, radmpc; print([m for m in sys.modules if 'viewing' in m])"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "[]\n"
