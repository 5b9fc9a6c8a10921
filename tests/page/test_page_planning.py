"""Operators draw, plan, look and ask why not, in a real browser."""

from __future__ import annotations

import re

import pytest
from serving_page import ROOT, STRAIT, until

pytestmark = pytest.mark.slow  # each in a browser

HARBOR = ROOT / "src" / "radmpc" / "data" / "harbor.yaml"
PLAN = re.compile("^Plan at Δ")


def test_a_vehicle_and_an_obstacle_are_drawn_on_an_empty_map(screen):
    page = screen()
    page.button("Open or new").first.click()
    page.button("Empty scenario").click()
    page.button("Vehicle", exact=True).click()
    page.click(4, 5)
    page.click(30, 20)
    until(lambda: len(page.content["vehicles"]) == 1)
    page.button("Box", exact=True).click()
    page.click(12, 9)
    page.click(18, 16)
    until(lambda: len(page.content["obstacles"]) == 1)
    [vehicle] = page.state["view"]["vehicles"]
    assert max(abs(vehicle["start"][0] - 4), abs(vehicle["start"][1] - 5)) < 0.2
    [obstacle] = page.state["view"]["obstacles"]
    corners = [corner for ring in obstacle["rings"] for corner in ring]
    assert max(abs(max(x for x, _ in corners) - 18), abs(min(y for _, y in corners) - 9)) < 0.2
    things = page.page.get_by_role("listbox", name="Things of the scenario")
    until(lambda: things.get_by_role("option").count() == 4)  # with the goal and the workspace


def test_a_plan_is_found_and_shown_with_its_certificate(screen, server):
    page = screen(server.open("planned.yaml", STRAIT))
    panel = page.tab("Plan")
    page.button(PLAN).click()
    until(lambda: page.state["plans"])
    until(lambda: page.state["searches"][-1]["state"] == "ended")
    assert page.state["plans"][-1]["holds"]
    panel.get_by_role("radio", name=re.compile("^Show: cost")).first.wait_for()
    page.tab("Risk").get_by_text("holds", exact=True).wait_for()
    page.page.get_by_role("img", name=re.compile("^Shares of Δ: .*[Oo]bstacles")).wait_for()


def test_plans_that_get_better_are_shown_as_they_come_and_stop_keeps_the_best(screen, server):
    text = HARBOR.read_text(encoding="utf-8")
    page = screen(server.open("harbor.yaml", text))
    panel = page.tab("Plan")
    panel.get_by_label("Gap").fill("0.0001")
    page.button(PLAN).click()
    page.button("Stop").wait_for()
    until(lambda: page.state["plans"], 90.0)
    panel.get_by_role("radio", name=re.compile("^Show: cost")).first.wait_for()
    stop = page.button("Stop")
    if stop.is_visible():
        stop.click()
    until(lambda: page.state["searches"][-1]["state"] == "ended")
    costs = [plan["cost"] for plan in page.state["plans"]]
    assert costs == sorted(costs, reverse=True)
    page.button(PLAN).wait_for()


def test_an_obstacle_dragged_onto_a_goal_says_why_not_at_the_place(screen, server):
    page = screen(server.open("blocked.yaml", STRAIT))
    page.map.wait_for()
    page.click(9, 5)
    page.drag((9.5, 5.5), (18, 6))
    until(lambda: any(one["severity"] == "fatal" for one in page.state["remarks"]))
    mark = page.page.locator(".marks button").first
    mark.wait_for()
    mark.click()
    said = next(one for one in page.state["remarks"] if one["severity"] == "fatal")
    page.page.locator(".marks .words").get_by_text(said["text"]).first.wait_for()
    page.button("Undo").click()
    until(lambda: all(one["severity"] != "fatal" for one in page.state["remarks"]))


def test_a_cure_is_a_button_that_removes_its_cause(screen, server):
    page = screen(server.open("hasty.yaml", STRAIT.replace("horizon: 8", "horizon: 3")))
    until(lambda: any(one["cures"] for one in page.state["remarks"]))
    label = next(one for one in page.state["remarks"] if one["cures"])["cures"][0]["label"]
    page.tab("Plan")
    page.button(label).first.click()
    until(lambda: page.content["horizon"] > 3)
    until(lambda: all(one["severity"] == "warning" for one in page.state["remarks"]))


def test_the_slider_says_what_another_risk_bound_would_cost_and_two_plans_are_compared(
    screen, server
):
    document = server.open("priced.yaml", STRAIT)
    for bound in (0.05, 0.005):
        server.planned(document, riskBound=bound)
    page = screen(document)
    panel = page.tab("Plan")
    dots = page.button(re.compile("^Show the plan of cost"))
    until(lambda: dots.count() == 2)
    dots.first.click()
    slider = panel.get_by_role("slider", name=re.compile("^Risk bound"))
    said = panel.get_by_text(re.compile(r"^Cost at .*: (found|about|at most)"))
    before = said.inner_text()
    slider.press("ArrowLeft")
    slider.press("PageDown")
    until(lambda: said.inner_text() != before)
    page.button(re.compile("^Compare vs")).first.click()
    panel.get_by_role("heading", name="Compared").wait_for()
    assert page.button(re.compile(r"^(tug|ferry)\W+apart at most")).count() >= 1


def test_a_vehicle_is_moved_undone_and_done_again(screen, server):
    page = screen(server.open("undone.yaml", STRAIT))
    page.map.wait_for()
    page.page.get_by_role("option").first.wait_for()
    page.drag((2, 5), (3, 8))
    until(lambda: page.content["vehicles"][0]["start"] != [2, 5])
    x, y = page.content["vehicles"][0]["start"]
    assert max(abs(x - 3), abs(y - 8)) < 0.2
    page.page.keyboard.press("Control+z")
    until(lambda: page.content["vehicles"][0]["start"] == [2, 5])
    page.page.keyboard.press("Control+Shift+Z")
    until(lambda: page.content["vehicles"][0]["start"] == [x, y])


def test_what_is_saved_keeps_the_comments_of_its_file(screen, server):
    page = screen(server.open("kept.yaml", STRAIT))
    field = page.tab("Scene").get_by_role("textbox", name=re.compile("^Risk bound"))
    field.fill("0.02")
    field.press("Enter")
    until(lambda: page.content["risk_bound"] == 0.02)
    page.page.keyboard.press("Control+s")
    page.sees(re.compile("^Saved as"))
    text = (server.folder / "kept.yaml").read_text(encoding="utf-8")
    assert re.search(r"risk_bound: 0\.02 +# agreed with the pilots", text)
    assert "# dries at low water" in text


def test_a_file_that_somebody_else_has_changed_is_replaced_only_when_told_to(screen, server):
    page = screen(server.open("shared.yaml", STRAIT))
    page.map.wait_for()
    theirs = STRAIT.replace("dt: 1.0", "dt: 2.0")
    (server.folder / "shared.yaml").write_text(theirs, encoding="utf-8")
    page.page.keyboard.press("Control+s")
    asked = page.page.get_by_role("dialog", name="Save as")
    asked.get_by_text("has changed since it was read").wait_for()
    assert (server.folder / "shared.yaml").read_text(encoding="utf-8") == theirs
    # What cannot be written at all cannot be written over either.
    asked.get_by_label("Name in").fill("nowhere/shared.yaml")
    asked.get_by_role("button", name="Save", exact=True).click()
    asked.get_by_text("there is no such folder").wait_for()
    assert asked.get_by_role("button", name="Overwrite").count() == 0
    asked.get_by_label("Name in").fill("shared.yaml")
    asked.get_by_role("button", name="Save", exact=True).click()
    asked.get_by_role("button", name="Overwrite").click()
    page.sees(re.compile("^Saved as"))
    assert (server.folder / "shared.yaml").read_text(encoding="utf-8") == STRAIT


def test_what_is_being_typed_stays_while_the_document_changes_elsewhere(screen, server):
    page = screen(server.open("typed.yaml", STRAIT))
    panel = page.tab("Scene")
    field = panel.get_by_role("textbox", name=re.compile("^Risk bound"))
    field.fill("0.02")
    changes = [{"path": ["horizon"], "value": 9}]
    revision = page.state["revision"]
    server.call("change", document=page.document, revision=revision, changes=changes, label="Set")
    horizon = panel.get_by_role("textbox", name=re.compile("^Horizon"))
    until(lambda: horizon.input_value() == "9")
    assert field.input_value() == "0.02"
    field.press("Enter")
    until(lambda: page.content["risk_bound"] == 0.02)
    field.fill("much")
    field.press("Enter")
    until(lambda: field.get_attribute("aria-invalid") == "true")
    assert field.input_value() == "much"
    field.press("Escape")
    until(lambda: field.input_value() == "0.02")
    assert field.get_attribute("aria-invalid") == "false"


def test_all_of_it_is_done_by_keys_alone(screen, server):
    page = screen(server.open("keys.yaml", STRAIT))
    page.map.wait_for()
    keys = page.page.keyboard
    page.page.evaluate("document.activeElement.blur()")
    for _ in range(60):
        keys.press("Tab")
        if page.page.evaluate("document.activeElement.getAttribute('role')") == "option":
            break
    # The first is the workspace; Down goes to the next thing, and Enter to the map.
    keys.press("ArrowDown")
    chosen = page.page.get_by_role("option", selected=True)
    for _ in range(6):
        if chosen.count() and chosen.first.inner_text().startswith("tug"):
            break
        keys.press("ArrowDown")
    keys.press("Enter")
    keys.press("ArrowUp")
    until(lambda: page.content["vehicles"][0]["start"] != [2, 5])
    assert page.content["vehicles"][0]["start"][1] > 5
    keys.press("Escape")
    keys.press("n")
    for key in ("ArrowLeft", "Enter", "Shift+ArrowUp", "Enter"):
        keys.press(key)
    until(lambda: len(page.content["vehicles"]) == 3)


def test_keys_save_what_is_being_typed_and_work_with_the_focus_on_a_slider(screen, server):
    document = server.open("keyed.yaml", STRAIT)
    page = screen(document)
    page.tab("Scene").get_by_role("option", name=re.compile("^tug")).first.click()
    field = page.page.get_by_role("textbox", name="Radius in m")
    field.fill("0.35")
    page.page.keyboard.press("Control+s")
    page.sees(re.compile("^Saved as"))
    assert "0.35" in (server.folder / "keyed.yaml").read_text(encoding="utf-8")
    # The field still has the focus, and its own keys.
    page.page.keyboard.press("End")
    page.page.keyboard.type("n")
    assert field.input_value() == "0.35n"
    field.press("Escape")
    page.tab("Plan").get_by_role("slider").focus()
    page.page.keyboard.press("Control+z")
    until(lambda: "radius" not in page.content["vehicles"][0])
    page.page.keyboard.press("n")
    page.sees("Click where the vehicle starts")
