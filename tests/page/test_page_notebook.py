"""The view in notebooks: below styles that are not its own, and in JupyterLab itself."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from serving_page import BUNDLE, STRAIT, until

import radmpc
from radmpc.viewing.content import view_content

pytestmark = pytest.mark.slow  # each in a browser

# As of front ends: styles for texts, and for all that stands in an output.
FOREIGN = """
* { box-sizing: content-box; }
dl { display: grid; grid-template-columns: 1fr 4fr; }
dt { font-weight: 700; float: left; }
li { list-style: disc; margin: 20px; }
input { width: 20px; }
"""

SHOW = """
async ([code, style, contents]) => {
    const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    const { default: widget } = await import(address);
    window.said = [];
    window.ends = contents.map((content) => {
        const values = { content, time: 0, _style: style };
        const model = {
            get: (key) => values[key],
            set: (key, value) => { values[key] = value; },
            save_changes: () => window.said.push(values.time),
            on() {}, off() {}, send() {},
        };
        const el = document.body.appendChild(document.createElement("div"));
        return widget.render({ model, el });
    });
}
"""


@pytest.fixture
def notebook(browser: Any) -> Iterator[Any]:
    """A page that is not ours."""
    context = browser.new_context(viewport={"width": 1100, "height": 1200})
    page = context.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.set_content(f"<!doctype html><style>{FOREIGN}</style><body data-jp-theme-light=false>")
    yield page
    context.close()
    assert wrong == []


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> radmpc.Result:
    """A plan."""
    path = tmp_path_factory.mktemp("viewed") / "strait.yaml"
    path.write_text(STRAIT, encoding="utf-8")
    return radmpc.plan(radmpc.load_scenario(path), "multi-vehicle", rng=0)


def test_a_view_looks_its_own_way_among_the_styles_of_a_notebook(notebook, planned):
    code, style = ((BUNDLE / f"widget.{kind}").read_text("utf-8") for kind in ("js", "css"))
    contents = [view_content(value) for value in (planned, planned.plan.scenario)]
    notebook.evaluate(SHOW, [code, style, contents])
    views = notebook.locator(".radmpc-view")
    assert views.count() == 2
    time = views.first.get_by_role("slider", name="Time")
    assert time.bounding_box()["width"] > 600
    term = views.first.get_by_text("Risk ≤", exact=True)
    assert term.evaluate("e => getComputedStyle(e).fontWeight") == "400"
    assert term.evaluate("e => getComputedStyle(e).colorScheme") == "dark"
    # Labels are those of a view, though every view has the same ones.
    assert views.first.get_by_label("Vehicle").count() == 1
    row = views.first.get_by_role("button", name="most at step").first
    row.press("ArrowDown")
    assert row.evaluate("e => e.getRootNode().activeElement === e") is False
    time.press("End")
    until(lambda: notebook.evaluate("window.said") == [8])
    notebook.evaluate("window.ends.forEach((end) => end())")
    assert views.count() == 0


CELLS = (
    "import radmpc\nfrom pathlib import Path\n"
    "scenario = radmpc.load_scenario('strait.yaml')\n"
    "result = radmpc.plan(scenario, 'multi-vehicle', rng=0)\nradmpc.view(result)",
    "result",
    "drones = Path(radmpc.__file__).parent / 'data' / 'templates' / 'drones.yaml'\n"
    "radmpc.view(radmpc.load_scenario(drones))",
)


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[str]:
    """The address of a notebook in JupyterLab."""
    for module in ("jupyterlab", "ipykernel", "anywidget"):
        pytest.importorskip(module, reason=f"no {module} here: pip install jupyterlab anywidget")
    cells = [
        {"cell_type": "code", "id": f"cell{i}", "source": text, "outputs": [], "metadata": {}}
        | {"execution_count": None}
        for i, text in enumerate(CELLS)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    book = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    (tmp_path / "views.ipynb").write_text(json.dumps(book), encoding="utf-8")
    (tmp_path / "strait.yaml").write_text(STRAIT, encoding="utf-8")
    options = ("--no-browser", "--allow-root", "--ServerApp.ip=127.0.0.1", "--ServerApp.port=0")
    settings = (f"--ServerApp.root_dir={tmp_path}", "--IdentityProvider.token=t")
    homes = {name: str(tmp_path / name) for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR")}
    runtime = tmp_path / "runtime"
    process = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", *options, *settings],
        env={**os.environ, **homes, "JUPYTER_RUNTIME_DIR": str(runtime)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        [told] = until(lambda: list(runtime.glob("jpserver-*.json")), 300.0)
        port = until(lambda: json.loads(told.read_text(encoding="utf-8") or "{}").get("port"))
        yield f"http://127.0.0.1:{port}/lab/tree/views.ipynb?token=t&reset"
    finally:
        process.terminate()
        process.wait(timeout=60)


@pytest.mark.nightly
def test_jupyterlab_shows_views_that_keep_their_keys(lab, browser):
    context = browser.new_context(viewport={"width": 1440, "height": 1400})
    page = context.new_page()
    page.set_default_timeout(90_000)
    page.goto(lab)
    page.locator(".jp-Notebook .jp-Cell .cm-content").first.click()
    for _ in CELLS:
        page.keyboard.press("Shift+Enter")
    views = page.locator(".radmpc-view")
    until(lambda: views.count() == len(CELLS))
    time = views.first.get_by_role("slider", name="Time")
    assert time.bounding_box()["width"] > 400
    # Of a notebook, these would delete a cell and restart the kernel.
    for key in ("d", "d", "0", "0", "End"):
        time.press(key)
    assert time.input_value() == "8"
    assert views.count() == len(CELLS)
    assert page.get_by_role("dialog").count() == 0
    turned = views.last.locator(".space-host")
    turned.scroll_into_view_if_needed()
    until(lambda: turned.evaluate("e => !!e.space && e.space.frames > 0"))
    if folder := os.environ.get("RADMPC_SHOTS"):
        page.screenshot(path=Path(folder) / "jupyterlab.png")
    context.close()
