"""A client of the server, and a screen: places in meters, panels by their names."""

from __future__ import annotations

import itertools
import json
import re
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from websockets.sync.client import connect

import radmpc
from radmpc.model.dynamics import rollout

FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
"""For a browser that asks nobody for anything, and draws by the processor."""

ROOT = Path(__file__).parent.parent.parent
BUNDLE = ROOT / "src" / "radmpc" / "serving" / "bundle"

STRAIT = """\
format: radmpc/scenario/1
name: strait
dt: 1.0
horizon: 8               # steps
risk_bound: 0.05         # agreed with the pilots
avoidance: steps
workspace: {min: [0, 0], max: [20, 12]}
defaults:
  radius: 0.4
  speed_limit: 4.0
  control_limit: 2.0
  initial_covariance: [0.001, 0.001, 0.001, 0.001]
  disturbance_covariance: [0.0005, 0.0005, 0.001, 0.001]
  feedback: {lqr: {Q: [4, 4, 1, 1], R: 1}}
obstacles:
  - {name: rock, min: [8, 4], max: [11, 7]}   # dries at low water
vehicles:
  - {name: tug, start: [2, 5], goal: {center: [18, 6], half_width: 0.5}}
  - {name: ferry, start: [10, 1], goal: {center: [9.5, 10.5], half_width: 0.5}}
"""
"""Two vessels and a rock, planned in a fraction of a second."""


def bundle_is_there() -> bool:
    """Whether the page was built."""
    return (BUNDLE / "index.html").is_file()


def until(found: Callable[[], Any], seconds: float = 90.0) -> Any:
    """Return the first answer that is true; fail if there is none in time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        answer = found()
        if answer:
            return answer
        time.sleep(0.05)
    raise AssertionError(f"{found} did not come true within {seconds:g} s")


class Server:
    """The server as a program sees it.

    Attributes
    ----------
    address : str
        With the token, as it was printed.
    folder : Path
        Where it reads and writes.
    """

    def __init__(self, address: str, folder: Path) -> None:
        self.address, self.folder = address, folder
        parts = urlsplit(address)
        words = {**parse_qs(parts.query), **parse_qs(parts.fragment)}
        self.socket = f"ws://{parts.netloc}/socket?token={words['token'][0]}"
        self._stack = ExitStack()
        self._line = self._stack.enter_context(
            connect(self.socket, max_size=None, open_timeout=60, ping_interval=None)
        )
        self._numbers = itertools.count(1)

    def call(self, name: str, **args: Any) -> Any:
        """Return the answer to a call."""
        number = next(self._numbers)
        self._line.send(json.dumps({"id": number, "call": name, "args": args}))
        while True:
            message = json.loads(self._line.recv(timeout=60))
            if message.get("id") == number:
                assert "failure" not in message, message["failure"]
                return message["result"]

    def open(self, name: str, text: str) -> str:
        """Write a file into the folder, and return the document that it opens as."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return self.call("open", path=name)["document"]

    def documents(self) -> set[str]:
        """Return what is open."""
        return {one["document"] for one in self.call("hello")["documents"]}

    def state(self, document: str) -> dict[str, Any]:
        """Return a document as it is now."""
        return self.call("state", document=document)

    def planned(self, document: str, **options: Any) -> str:
        """Plan a document, and return the best plan that was found."""
        words = {"planner": "certified", "seconds": 20.0, "gap": None, "riskBound": None, **options}
        search = self.call("plan", document=document, **words)["search"]

        def ended() -> bool:
            searches = self.state(document)["searches"]
            return next(s for s in searches if s["search"] == search)["state"] != "running"

        until(ended, 60.0)
        return self.state(document)["plans"][-1]["plan"]

    def close(self) -> None:
        """Hang up."""
        self._stack.close()


class Screen:
    """A page, with places in meters and parts by their names."""

    def __init__(self, page: Any, server: Server) -> None:
        self.page, self.server = page, server

    @property
    def document(self) -> str:
        """The document that the page shows."""
        return self.page.evaluate("sessionStorage.getItem('document')")

    @property
    def state(self) -> dict[str, Any]:
        """The document, as the server has it."""
        return self.server.state(self.document)

    @property
    def content(self) -> dict[str, Any]:
        """What is in the document."""
        return self.state["content"]

    @property
    def map(self) -> Any:
        """The map, or the view in space."""
        return self.page.locator(".map [role=application]")

    def button(self, name: str, **options: Any) -> Any:
        """Return a button by the words on it."""
        return self.page.get_by_role("button", name=name, **options)

    def tab(self, name: str) -> Any:
        """Turn to a panel, and return it."""
        self.page.get_by_role("tab", name=name, exact=True).click()
        return self.page.get_by_role("tabpanel")

    def sees(self, text: str | re.Pattern[str], timeout: float = 60_000) -> Any:
        """Wait until words are to be seen."""
        found = self.page.get_by_text(text).first
        found.wait_for(timeout=timeout)
        return found

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return where a place of the map is on the screen [px]."""
        box = self.map.bounding_box()
        near, far = (
            (box["width"] * 0.25, box["height"] * 0.25),
            (
                box["width"] * 0.75,
                box["height"] * 0.75,
            ),
        )
        (x0, y0), (x1, y1) = self._place(box, near), self._place(box, far)
        per_x = (far[0] - near[0]) / (x1 - x0)
        per_y = (far[1] - near[1]) / (y1 - y0)
        return (
            box["x"] + near[0] + (x - x0) * per_x,
            box["y"] + near[1] + (y - y0) * per_y,
        )

    def _place(self, box: dict[str, float], pixel: tuple[float, float]) -> tuple[float, float]:
        """Return the place that the page shows for a pixel of the map [m]."""
        self.page.mouse.move(box["x"] + pixel[0], box["y"] + pixel[1])
        text = self.page.locator(".position").inner_text()
        numbers = re.findall(r"-?[\d.]+", text.replace("−", "-"))
        return float(numbers[0]), float(numbers[1])

    def click(self, x: float, y: float) -> None:
        """Click a place of the map [m]."""
        self.page.mouse.click(*self.at(x, y))

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag from one place of the map to another [m]."""
        (x0, y0), (x1, y1) = self.at(*start), self.at(*end)
        mouse = self.page.mouse
        mouse.move(x0, y0)
        mouse.down()
        mouse.move((x0 + x1) / 2, (y0 + y1) / 2)
        mouse.move(x1, y1)
        mouse.up()

    def violations(self) -> list[str]:
        """Return what axe-core finds wrong for who cannot see, or has no mouse."""
        if not self.page.evaluate("typeof axe === 'object'"):
            axe = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
            self.page.evaluate(axe.read_text(encoding="utf-8"))
        found = self.page.evaluate("axe.run(document, {resultTypes: ['violations']})")
        return [
            f"{one['id']}: {one['nodes'][0]['html'][:160]}: {one['nodes'][0]['failureSummary']}"
            for one in found["violations"]
        ]


def many_vehicles(count: int, path: Path) -> None:
    """Write a plan of vehicles that each drive a few meters, on a grid."""
    horizon, side = 20, int(np.ceil(np.sqrt(count)))
    system = radmpc.double_integrator(0.5, 2)
    controls = np.zeros((horizon, 2))
    controls[0], controls[-1] = (0.5, 0.2), (-0.5, -0.2)
    covariance = np.diag([0.01, 0.01, 1e-3, 1e-3])
    vehicles = []
    for number in range(count):
        start = np.array([*(4.0 * np.array(divmod(number, side))), 0.0, 0.0])
        end = rollout(system, start, controls)[-1, :2]
        goal = radmpc.Goal(end - 0.5, end + 0.5, np.full(2, 0.2))
        vehicles.append(
            radmpc.Vehicle(
                f"v{number}", system, start, goal, 0.3, np.ones(2), covariance, 0.01 * covariance
            )
        )
    scenario = radmpc.Scenario(
        name="many", dt=0.5, horizon=horizon, vehicles=vehicles, risk_bound=0.05
    )
    tracks = tuple(
        radmpc.Trajectory(
            vehicle.name,
            controls,
            rollout(system, vehicle.start, controls),
            vehicle.covariances(horizon),
        )
        for vehicle in vehicles
    )
    plan = radmpc.Plan(
        scenario=scenario,
        planner="drawn",
        seed=0,
        status=radmpc.Status.FEASIBLE,
        cost=sum(float(np.abs(controls).sum()) for _ in vehicles),
        lower_bound=None,
        risk=radmpc.Risk(0.05),
        sets=tuple((vehicle.name,) for vehicle in vehicles),
        trajectories=tracks,
    )
    radmpc.save_plan(plan, path)
