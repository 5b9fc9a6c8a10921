"""Operators watch plans, simulations and flights, in a real browser."""

from __future__ import annotations

import itertools
import json
import re

import numpy as np
import pytest
from serving_page import ROOT, STRAIT, Server, many_vehicles, until

import radmpc

pytestmark = pytest.mark.slow  # each in a browser


@pytest.fixture(scope="module")
def strait(server: Server) -> str:
    """A document with a plan, to be looked at."""
    document = server.open("watched.yaml", STRAIT)
    server.planned(document)
    return document


def shown(screen, document, **options):
    """Open a document and show its plan."""
    page = screen(document, **options)
    page.tab("Plan").get_by_role("radio", name=re.compile("^Show: cost")).last.check()
    return page


def steps(page) -> float:
    """Where the timeline stands [steps]."""
    return float(page.page.get_by_role("slider", name="Time").input_value())


def test_time_is_scrubbed_and_played_to_the_end(screen, strait):
    page = shown(screen, strait)
    slider = page.page.get_by_role("slider", name="Time")
    slider.press("ArrowRight")
    assert steps(page) == 1
    slider.press("End")
    assert steps(page) == 8
    page.page.get_by_role("combobox", name="Speed").select_option("10")
    page.button("Play").click()
    until(lambda: 0 < steps(page) < 8)
    until(lambda: steps(page) == 8)
    page.button("Play").wait_for()


def test_a_line_of_the_ledger_leads_to_its_place_and_time(screen, strait):
    page = shown(screen, strait)
    row = page.tab("Risk").get_by_role("button", name=re.compile(r"most at step \d+")).first
    row.hover()
    step = float(re.search(r"most at step\s+(\d+)", row.text_content())[1])
    until(lambda: steps(page) == step)
    page.page.mouse.move(5, 5)
    until(lambda: steps(page) == 0)
    row.click()
    until(lambda: steps(page) == step)
    assert row.get_attribute("aria-expanded") == "true"


def test_simulated_missions_are_counted_against_the_certificate(screen, strait):
    page = shown(screen, strait)
    panel = page.tab("Risk")
    panel.get_by_role("textbox", name="Missions").fill("2000")
    page.button("Simulate").click()
    panel.get_by_text(re.compile(r"of 2.?000$")).wait_for()
    panel.get_by_text(re.compile("certified")).last.wait_for()
    assert page.page.get_by_text("Trails on the map").is_visible()


def test_a_plan_is_flown_and_its_ticks_are_told(screen, strait):
    page = shown(screen, strait)
    panel = page.tab("Flight")
    panel.get_by_label("Pace").select_option("0")
    panel.get_by_label("Log file").fill("kept.flight.jsonl")
    page.tab("Risk")
    page.tab("Flight")
    assert panel.get_by_label("Pace").input_value() == "0"
    assert panel.get_by_label("Log file").input_value() == "kept.flight.jsonl"
    panel.get_by_label("Log file").fill("")
    page.button("Fly", exact=True).click()
    until(lambda: page.state["flights"] and page.state["flights"][-1]["state"] != "running", 90.0)
    flight = page.state["flights"][-1]
    assert flight["state"] == "ended", flight["note"]
    assert flight["ticks"][-1]["step"] == 8
    panel.get_by_text("ended, step 8 of 8").wait_for()
    page.page.get_by_role("img", name=re.compile("Δ|account", re.I)).first.wait_for()


def test_files_of_flights_are_opened_and_scrubbed(screen, server, strait):
    plan = radmpc.plan(radmpc.load_scenario(server.folder / "watched.yaml"), rng=0).require()
    page = screen()
    # The second has as many flights as the document that is left.
    for day in ("monday", "tuesday"):
        radmpc.begin_flight(plan, radmpc.FlightSettings(), server.folder / f"{day}.flight.jsonl")
        page.button("Open or new").first.click()
        page.button(re.compile(rf"^{day}\.flight\.jsonl")).click()
        page.page.get_by_role("dialog").wait_for(state="hidden")
        page.tab("Flight").get_by_text(re.compile("step 8 of 8")).wait_for(timeout=20_000)
    slider = page.page.get_by_role("slider", name="Time")
    slider.press("End")
    assert steps(page) == 8


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_panel_can_be_read_and_used_by_everyone(screen, strait, scheme):
    page = shown(screen, strait, color_scheme=scheme)
    assert page.page.evaluate("document.documentElement.dataset.theme") == scheme
    found = {}
    for name in ("Plan", "Risk", "Flight", "Scene"):
        page.tab(name)
        if bad := page.violations():
            found[name] = bad
    assert found == {}


def test_the_dialogs_can_be_read_and_used_by_everyone(screen):
    page = screen()
    page.button("Open or new").first.click()
    page.page.get_by_role("dialog").wait_for()
    assert page.violations() == []
    page.page.keyboard.press("Escape")
    page.page.keyboard.press("?")
    page.page.get_by_role("dialog", name="Keys").wait_for()
    assert page.violations() == []


def test_a_phone_shows_all_of_it_without_scrolling_aside(screen, strait):
    page = shown(screen, strait, width=390, height=844)
    for name in ("Plan", "Risk", "Flight", "Scene"):
        page.tab(name)
        wide = page.page.evaluate("document.documentElement.scrollWidth")
        assert wide <= 390, f"{name}: {wide} px"
    box = page.map.bounding_box()
    assert box["width"] >= 380
    assert box["height"] >= 250


def test_a_low_screen_as_at_twice_the_size_shows_all_of_the_map(screen, strait):
    page = shown(screen, strait, width=720, height=450)
    box = page.map.bounding_box()
    assert box["width"] >= 300
    assert box["height"] >= 250
    for corner in ((0, 0), (20, 12)):
        x, y = page.at(*corner)
        assert box["x"] <= x <= box["x"] + box["width"]
        assert box["y"] <= y <= box["y"] + box["height"]
    assert page.page.evaluate("document.documentElement.scrollWidth") <= 720


def test_a_screen_as_at_four_times_the_size_is_scrolled_to_all_of_it(screen, strait):
    page = shown(screen, strait, width=320, height=256)
    assert page.map.bounding_box()["height"] >= 150
    toolbar, timeline = page.page.locator(".toolbar"), page.page.locator(".timeline")
    for name in ("Plan", "Risk", "Flight", "Scene"):
        page.tab(name)
        assert page.page.evaluate("document.documentElement.scrollWidth") <= 320
    bottom = toolbar.bounding_box()["y"] + toolbar.bounding_box()["height"]
    assert bottom <= page.map.bounding_box()["y"] < timeline.bounding_box()["y"]


def test_numbers_and_long_names_of_the_ledger_are_all_to_be_read_in_narrow_panels(screen, server):
    longer = STRAIT.replace("tug", "tug of the northern flotilla that is named at great length")
    document = server.open("longer.yaml", longer)
    server.planned(document)
    page = screen(document, width=720, height=450)
    panel = page.tab("Risk")
    panel.get_by_text("holds").wait_for()
    cut = """panel => [...panel.querySelectorAll('dd, .p-name')].filter(one =>
        one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline'
        || one.getBoundingClientRect().right > panel.getBoundingClientRect().right
    ).map(one => one.textContent)"""
    assert panel.evaluate(cut) == []


def test_scenes_in_space_turn_by_hand_and_by_keys(screen, server):
    drones = ROOT / "src" / "radmpc" / "data" / "templates" / "drones.yaml"
    page = screen(server.open("drones.yaml", drones.read_text(encoding="utf-8")))
    until(lambda: page.page.evaluate("!!document.querySelector('.space-host')?.space"))
    direction = "document.querySelector('.space-host').space.direction"
    frames = "document.querySelector('.space-host').space.frames"
    first, drawn = page.page.evaluate(direction), page.page.evaluate(frames)
    box = page.map.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    page.page.mouse.move(x + 100, y)
    page.page.mouse.up()
    turned = page.page.evaluate(direction)
    assert turned["azimuth"] == pytest.approx(first["azimuth"] - 0.6)
    page.map.press("ArrowUp")
    assert page.page.evaluate(direction)["elevation"] > turned["elevation"]
    until(lambda: page.page.evaluate(frames) > drawn)
    # Not one color: something is there.
    picture = np.frombuffer(page.map.screenshot(), dtype=np.uint8)
    assert len(picture) > 10_000
    assert page.page.locator(".space-labels").get_by_text("x [m]").is_visible()
    assert page.violations() == []


def test_thirty_drones_in_space_have_their_names_beside_them(screen, server):
    places = [(4 * (i % 6), 4 * (i // 6), 2 + i % 3) for i in range(30)]
    vehicles = [
        {"name": f"drone {i}", "start": list(at), "goal": {"center": [at[0], at[1], 9]}}
        for i, at in enumerate(places)
    ]
    content = {"format": "radmpc/scenario/1", "name": "swarm", "dt": 0.5, "horizon": 10}
    content |= {"risk_bound": 0.05, "vehicles": vehicles}
    content |= {"defaults": {"radius": 0.2, "control_limit": 5, "initial_covariance": 0.001}}
    document = server.open("swarm.yaml", json.dumps(content))
    page = screen(document)
    names = page.page.locator(".space-name:visible")

    def drawn():
        """Return where names are, once none is being placed anew."""
        boxes = [name.bounding_box() for name in names.all()]
        return boxes if len(boxes) >= 20 and None not in boxes else None

    for one, two in itertools.combinations(until(drawn), 2):
        is_apart = abs(one["x"] - two["x"]) >= min(one["width"], two["width"])
        assert is_apart or abs(one["y"] - two["y"]) >= one["height"]
    server.call("close", document=document)


def test_a_thousand_vehicles_scrub_in_thirty_frames_a_second(screen, server):
    many_vehicles(1000, server.folder / "thousand.plan.json")
    document = server.call("open", path="thousand.plan.json")["document"]
    page = shown(screen, document)
    until(lambda: page.page.get_by_role("slider", name="Time").is_enabled())
    devtools = page.page.context.new_cdp_session(page.page)
    # Seconds of the processor, not of the wall: whoever shares it does not count.
    devtools.send("Performance.enable", {"timeDomain": "threadTicks"})

    def worked() -> float:
        metrics = devtools.send("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "TaskDuration")

    before = worked()
    frames = page.page.evaluate(
        """async () => {
            const slider = document.querySelector("input[type=range][aria-label=Time]");
            const set = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
            let frames = 0;
            for (let k = 0; k < 20; k += 1) {
                set.call(slider, String((k / 20) * Number(slider.max)));
                slider.dispatchEvent(new Event("input", { bubbles: true }));
                await new Promise(requestAnimationFrame);
                frames += 1;
            }
            return frames;
        }"""
    )
    assert frames == 20
    assert (worked() - before) / frames < 1 / 30
