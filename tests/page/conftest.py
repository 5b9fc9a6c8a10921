"""A real server, a real browser, and what tests of the page look through."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import sync_playwright
from serving_page import FLAGS, Screen, Server, bundle_is_there

ROOT = Path(__file__).parent.parent.parent


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """`radmpc serve` in an empty folder."""
    if not bundle_is_there():
        pytest.skip("the page is not built: make page")
    folder = tmp_path_factory.mktemp("served")
    words = [sys.executable, "-m", "radmpc", "serve", "--folder", str(folder), "--port", "0"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        server = Server(process.stdout.readline().split()[-1], folder)
        yield server
        server.close()
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)


# One per file: Playwright's loop must not be there while tests of other files run their own.
@pytest.fixture(scope="module")
def browser(server: Server) -> Iterator[Any]:
    """Chromium without a window."""
    del server  # without a page there is nothing to start a browser for
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("there is no Chromium here")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture
def screen(
    browser: Any, server: Server, request: pytest.FixtureRequest
) -> Iterator[Callable[..., Screen]]:
    """Opens pages of the server, each as in a browser of its own; nothing may go wrong in them."""
    contexts: list[Any] = []
    wrong: list[str] = []
    before = server.documents()

    def opened(
        document: str | None = None,
        *,
        width: int = 1440,
        height: int = 900,
        line: Callable[[Any], None] | None = None,
        **options: Any,
    ) -> Screen:
        options = {"reduced_motion": "reduce", **options}
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        if line is not None:
            page.route_web_socket(re.compile("/socket"), line)
        page.set_default_timeout(60_000)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("console", lambda said: said.type == "error" and wrong.append(said.text))
        if document is not None:
            page.add_init_script(
                "if (!sessionStorage.getItem('document')) "
                f"sessionStorage.setItem('document', {json.dumps(document)})"
            )
        screen = Screen(page, server)
        page.goto(server.address)
        return screen

    yield opened
    # To see what a test saw: RADMPC_SHOTS=folder.
    if folder := os.environ.get("RADMPC_SHOTS"):
        pages = [page for context in contexts for page in context.pages]
        for number, page in enumerate(pages):
            page.screenshot(path=Path(folder) / f"{request.node.name}-{number}.png")
    for context in contexts:
        context.close()
    # There may be no more than twenty, and all tests of a process share the server.
    for document in server.documents() - before:
        server.call("close", document=document)
    assert wrong == []
