"""Pictures of the page of ``radmpc serve``, drawn by a browser: ``make pictures``."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

from making import ROOT

__all__ = ["SCREENS", "draw_screens"]

_WIDTH, _COLORS, _SURFACES = 1100, 128, 24  # of a picture [px], of its palette, exact ones

_FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@contextmanager
def _served(folder: Path, plan: Path) -> Iterator[str]:
    """Serve a plan, and yield the page's address."""
    words = [sys.executable, "-m", "radmpc", "serve", str(plan), "--folder", str(folder)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        yield process.stdout.readline().split()[-1]
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=30)


def _turn_to(page: Any, tab: str, time: float) -> None:
    """Show a panel, the plan, and a time [steps]."""
    page.get_by_role("tab", name="Plan").click()
    page.get_by_role("radio", name=re.compile("^Show: cost")).last.check()
    page.get_by_role("tab", name=tab, exact=True).click()
    page.get_by_role("slider", name="Time").fill(str(time))
    page.mouse.move(2, 2)
    page.wait_for_timeout(1500)


def _harbor_plan(page: Any) -> None:
    """Show what is found."""
    _turn_to(page, "Plan", 6.5)


def _harbor_risk(page: Any) -> None:
    """Show where the risk is, with missions flown."""
    _turn_to(page, "Risk", 9)
    page.get_by_role("button", name="Simulate").click()
    page.get_by_text("Trails on the map").wait_for()
    page.wait_for_timeout(1500)


def _drones(page: Any) -> None:
    """Show a scene in space."""
    _turn_to(page, "Risk", 7)


SCREENS: dict[str, tuple[str, tuple[int, int], str, Callable[[Any], None]]] = {
    "plan.png": ("harbor.yaml", (1280, 760), "light", _harbor_plan),
    "risk.png": ("harbor.yaml", (1280, 760), "dark", _harbor_risk),
    "phone.png": ("harbor.yaml", (390, 780), "light", _harbor_risk),
    "space.png": ("templates/drones.yaml", (1280, 760), "light", _drones),
}
"""Scenario, size [px], colors and what is done, by the picture's name."""


def draw_screens(images: Path) -> None:
    """Draw the page, if it was built and a browser is here.

    Parameters
    ----------
    images : Path
        Where to.
    """
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    bundle = ROOT / "src" / "radmpc" / "serving" / "bundle" / "index.html"
    if chromium is None or not bundle.is_file():
        sys.stderr.write("pictures of the page stay: they need Chromium, and `make page`\n")
        return
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - tests ask for names alone

    with TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        browser = playwright.chromium.launch(executable_path=chromium, args=list(_FLAGS))
        for target, (scenario, (width, height), colors, act) in SCREENS.items():
            with _served(folder, _planned(scenario, folder)) as address:
                looks: Any = {
                    "viewport": {"width": width, "height": height},
                    "color_scheme": colors,
                }
                page = browser.new_page(**looks)
                page.set_default_timeout(120_000)
                page.goto(address)
                act(page)
                page.screenshot(path=folder / target)
                page.close()
            _write_small(folder / target, images / "page" / target)
        browser.close()


def _write_small(source: Path, target: Path) -> None:
    """Write a screen with few pixels and a palette that keeps the colors of small things."""
    with Image.open(source) as image:
        width = min(image.width, _WIDTH)
        size = width, round(image.height * width / image.width)
        small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    colors = _palette(small)
    small.quantize(palette=colors, dither=Image.Dither.NONE).save(target, optimize=True)


def _palette(image: Image.Image) -> Image.Image:
    """Return colors for a screen: its large surfaces' own, and some for small things.

    A palette of means would tint all of a page that is white.
    """
    counted: Any = image.getcolors(image.width * image.height)
    exact = [color for _, color in sorted(counted, reverse=True)[:_SURFACES]]
    rest = image.quantize(_COLORS - _SURFACES, Image.Quantize.MAXCOVERAGE).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([value for color in exact for value in color] + rest)
    return palette


def _planned(scenario: str, folder: Path) -> Path:
    """Return the file of a shipped scenario's plan."""
    import radmpc  # noqa: PLC0415 - as above

    path = folder / (Path(scenario).stem + ".plan.json")
    if not path.is_file():
        source = ROOT / "src" / "radmpc" / "data" / scenario
        radmpc.save_plan(radmpc.plan(radmpc.load_scenario(source), rng=0).require(), path)
    return path
