"""Nothing is lost: reloads, broken lines, two pages at once, files from elsewhere."""

from __future__ import annotations

import json
import re

import pytest
from serving_page import ROOT, STRAIT, until

pytestmark = pytest.mark.slow  # each in a browser

LOST = re.compile("^Connection lost")
HARBOR = ROOT / "src" / "radmpc" / "data" / "harbor.yaml"
PLAN = re.compile("^Plan at Δ")


def test_a_reload_loses_nothing(screen, server):
    document = server.open("reloaded.yaml", STRAIT)
    page = screen(document)
    page.map.wait_for()
    page.page.get_by_role("option").first.wait_for()
    page.drag((2, 5), (3, 8))
    until(lambda: page.content["vehicles"][0]["start"] != [2, 5])
    page.button("Zoom in").click()
    place = page.at(10, 6)
    page.page.wait_for_timeout(400)  # the camera is kept once it rests
    page.page.reload()
    page.map.wait_for()
    assert page.document == document
    page.button("Undo").wait_for()
    until(lambda: page.button("Undo").is_enabled())
    again = page.at(10, 6)
    assert max(abs(a - b) for a, b in zip(place, again, strict=True)) < 3
    page.button("Undo").click()
    until(lambda: page.content["vehicles"][0]["start"] == [2, 5])


def test_a_connection_that_was_lost_comes_back_with_what_was_done_since(screen, server):
    lines, is_cut = [], [False]

    def connected(line):
        lines.append(line)
        if is_cut[0]:
            line.close(code=1012)
        else:
            line.connect_to_server()

    document = server.open("lost.yaml", STRAIT)
    page = screen(document, line=connected)
    page.tab("Scene").get_by_text("2 vehicles, 1 obstacle").wait_for()
    is_cut[0] = True
    lines[-1].close(code=1012)
    page.sees(LOST)
    # What is said of it lies over no control.
    page.page.get_by_role("tab", name="Plan").click(trial=True, timeout=5_000)
    change = [{"path": ["obstacles"], "value": []}]
    revision = server.state(document)["revision"]
    server.call("change", document=document, revision=revision, changes=change, label="Clear")
    is_cut[0] = False
    page.tab("Scene").get_by_text("2 vehicles, 0 obstacles").wait_for()
    page.page.get_by_text(LOST).wait_for(state="hidden")


@pytest.mark.parametrize("answer", ["hello", "state"])
def test_what_is_opened_while_a_page_still_loads_stays(screen, server, answer):
    slow = server.open("slow.yaml", STRAIT)
    lines, asked, held = [], [], []

    def connected(line):
        def sent(text):
            message = json.loads(text)
            if message["call"] == answer:
                asked.append(message["id"])
            there.send(text)

        def answered(text):
            is_first = json.loads(text).get("id") in asked[:1]
            held.append(text) if is_first else line.send(text)

        there = line.connect_to_server()
        line.on_message(sent)
        there.on_message(answered)
        lines.append(line)

    page = screen(slow, line=connected)
    # Messages pass only while the browser is asked for something.
    until(lambda: page.page.wait_for_timeout(20) or held)
    if answer == "hello":
        assert page.tab("Scene").inner_text() == "Opening …"
        assert page.page.get_by_text("Nothing is open.").count() == 0
    page.button("Open or new").first.click()
    page.button("Empty scenario").click()
    empty = page.tab("Scene").get_by_text("0 vehicles, 0 obstacles")
    empty.wait_for()
    lines[0].send(held[0])
    page.page.wait_for_timeout(300)
    empty.wait_for()


def test_two_pages_show_the_same_document(screen, server):
    document = server.open("shared.yaml", STRAIT)
    one = screen(document)
    two = screen(document)
    for page in (one, two):
        page.map.wait_for()
    one.drag((2, 5), (3, 8))
    until(lambda: one.content["vehicles"][0]["start"] != [2, 5])
    until(lambda: two.button("Undo").is_enabled())
    two.button("Undo").click()
    until(lambda: two.content["vehicles"][0]["start"] == [2, 5])
    until(lambda: one.button("Redo").is_enabled())


def test_what_is_typed_stays_with_its_vehicle_when_another_page_removes_one_before_it(
    screen, server
):
    document = server.open("typed.yaml", STRAIT)
    page = screen(document)
    page.tab("Scene")
    page.page.get_by_role("option", name=re.compile("^ferry")).first.click()
    field = page.page.get_by_role("textbox", name="Radius in m")
    field.press_sequentially("0.3")
    revision = server.state(document)["revision"]
    change = [{"path": ["vehicles", 0]}]
    server.call("change", document=document, revision=revision, changes=change, label="Remove")
    page.page.get_by_text("1 vehicle, 1 obstacle").wait_for()
    # Where the focus still is.
    page.page.keyboard.type("5")
    page.page.keyboard.press("Enter")
    until(lambda: [v.get("radius") for v in page.content["vehicles"]] == [0.35])
    page.page.get_by_role("heading", name="ferry").wait_for()


def test_what_is_open_and_never_saved_is_found_again_after_another_was_opened(screen, server):
    server.open("other.yaml", STRAIT)
    page = screen()
    for choice in (page.button("Empty scenario"), page.button(re.compile("^other.yaml"))):
        page.button("Open or new").first.click()
        choice.click()
        page.page.locator("dialog").wait_for(state="hidden")
    page.tab("Scene").get_by_text("2 vehicles, 1 obstacle").wait_for()
    page.button("Open or new").first.click()
    page.button("untitled", exact=True).last.click()
    page.tab("Scene").get_by_text("0 vehicles, 0 obstacles").wait_for()


def test_a_chart_dropped_on_the_page_becomes_obstacles(screen):
    page = screen()
    page.button("Open or new").first.wait_for()
    chart = (ROOT / "instances" / "drawn" / "marina.geojson").read_text(encoding="utf-8")
    transfer = page.page.evaluate_handle(
        """(content) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([content], "marina.geojson"));
            return transfer;
        }""",
        chart,
    )
    page.page.dispatch_event(".shell", "drop", {"dataTransfer": transfer})
    # In a document of its own, or in the one that another test has left open.
    until(lambda: page.document is not None and len(page.state["view"]["obstacles"]) > 0)
    page.tab("Scene").get_by_text(re.compile(r"\d+ vehicles?, \d+ obstacle")).wait_for()


def test_a_file_that_cannot_be_opened_is_told_of_in_the_dialog_that_it_was_chosen_in(
    screen, server
):
    (server.folder / "wrong.yaml").write_text("format: radmpc/scenario/1\nname: [\n", "utf-8")
    page = screen(server.open("right.yaml", STRAIT))
    page.map.wait_for()
    page.button("Open or new").first.click()
    dialog = page.page.get_by_role("dialog", name="Open")
    dialog.get_by_role("button", name="wrong.yaml").click()
    dialog.get_by_role("alert").get_by_text("wrong.yaml").wait_for()
    dialog.get_by_role("button", name="Dismiss").click()
    assert dialog.get_by_role("alert").count() == 0


def test_a_page_with_another_token_is_told_so_and_shown_nothing(screen):
    page = screen()
    page.page.evaluate("sessionStorage.setItem('token', 'wrong')")
    page.page.reload()
    page.sees(re.compile("does not know this page"))


def test_the_focus_stays_near_what_it_was_on_when_that_goes_away(screen, server):
    page = screen(server.open("focused.yaml", HARBOR.read_text(encoding="utf-8")))
    focused, keys = page.page.locator(":focus"), page.page.keyboard
    # A dialog begins where a name is typed.
    page.tab("Scene").get_by_role("option", name="islet").click()
    page.button("focused.yaml").click()
    page.page.locator("dialog input:focus").wait_for()
    keys.press("Escape")
    # The last obstacle is removed: the workspace comes to be at its place.
    entries = page.page.get_by_role("option").filter(visible=True)
    entry = entries.nth(entries.count() - 2)
    entry.focus()
    entry.press("Enter")
    entry.focus()
    keys.press("Delete")
    until(lambda: len(page.content["obstacles"]) == 2)
    until(lambda: focused.count() and focused.inner_text().startswith("workspace"))
    keys.press("ArrowDown")
    page.page.get_by_role("option", name="workspace", selected=True).wait_for()
    panel = page.tab("Plan")
    panel.get_by_label("Gap").fill("0.0000001")
    page.button(PLAN).click()
    page.button("Stop").press("Enter")
    until(lambda: page.state["searches"][-1]["state"] == "ended")
    until(lambda: focused.count() and focused.inner_text().startswith("Plan at Δ"))
