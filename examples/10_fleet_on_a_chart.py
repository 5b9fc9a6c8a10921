"""A fleet on a chart.

What an operator drew on a map becomes a scenario, a plan, and a mission for each boat: GeoJSON in,
QGroundControl and GeoJSON out. Two more boats are drawn here on the chart of a marina. The
number checks the whole way, there and back: how far, in meters along the earth, the last waypoint
of a boat's mission lies from the goal that was drawn. The farthest ends in a corner of its goal,
which the importer makes a square of a quarter radius around the point.
"""

import json
from pathlib import Path

import numpy as np

import radmpc

EXPECTED = 0.25 * 1.5 * 2.0**0.5  # the radius is 1.5 m
TOLERANCE = 0.05  # waypoints are rounded to 1e-7 degrees, the earth to a sphere

CHART = Path(__file__).parent.parent / "instances" / "drawn" / "marina.geojson"
MORE = {  # start and goal, longitude and latitude
    "charlie": ([10.1446, 54.3329], [10.1459, 54.3325]),
    "delta": ([10.1451, 54.3322], [10.1446, 54.3328]),
}


def main(out: Path) -> float:
    """Import, plan, export, animate, and return the largest distance from a drawn goal."""
    chart = json.loads(CHART.read_text(encoding="utf-8"))
    limits = {"radius": 1.5, "speed": 2.0, "acceleration": 0.5}
    for name, way in MORE.items():
        for role, place in zip(("start", "goal"), way, strict=True):
            properties = {"role": role, "vehicle": name, **(limits if role == "start" else {})}
            point = {"type": "Point", "coordinates": place}
            chart["features"] += [{"type": "Feature", "properties": properties, "geometry": point}]
    (out / "marina.geojson").write_text(json.dumps(chart), encoding="utf-8")

    imported = radmpc.import_scenario(out / "marina.geojson", radmpc.ImportOptions(horizon=16))
    plan = radmpc.plan(imported.scenario).require()
    radmpc.save_animation(plan, out / "10_fleet_on_a_chart.gif", frames_per_step=2)
    radmpc.save_exported(radmpc.export_plan(plan, "geojson", out / "plan.geojson"))
    missions = radmpc.export_plan(plan, "qgc", out / "mission.plan")
    radmpc.save_exported(missions)

    goals = {name: way[1] for name, way in MORE.items()}
    goals |= {"alpha": [10.1458, 54.3323], "bravo": [10.1443, 54.3325]}
    distances = []
    for path, name in missions.vehicles.items():
        latitude, longitude = json.loads(path.read_text())["mission"]["items"][-1]["params"][4:6]
        north = np.radians(latitude - goals[name][1])
        east = np.radians(longitude - goals[name][0]) * np.cos(np.radians(latitude))
        distances.append(6.371e6 * np.hypot(east, north))
    return float(max(distances))


if __name__ == "__main__":
    print("farthest last waypoint from its drawn goal [m]:", main(Path()))
