"""Walls without thickness between the points of the lattice on which an import looks for paths."""

from __future__ import annotations

from pathlib import Path

from drawings import drawing, line, place, point, polygon, written

from radmpc.importing.formats import import_scenario


def test_a_fence_around_the_start_is_no_narrow_passage(tmp_path: Path) -> None:
    # Points of the lattice may lie on both sides of it, closer to each other than its hulls reach.
    ring = [place(x, y) for x, y in ((-0.8, -0.3), (-0.2, -0.3), (-0.2, 0.2), (-0.8, 0.2))]
    fence = line("LineString", [*ring, ring[0]], role="obstacle", name="fence")
    imported = import_scenario(written(tmp_path, drawing(fence)))
    assert imported.scenario.vehicles[0].radius == 1.5
    assert imported.warnings == (
        "between start and goal of 'a' a hull of 1.5 m finds no path with clearance for noise",
    )


def test_paths_on_a_coarse_lattice_lead_around_a_thin_wall(tmp_path: Path) -> None:
    # Of a map of kilometers the lattice's points lie farther apart than a hull is wide.
    content = {
        "type": "FeatureCollection",
        "features": [
            point(-2.05, 0, role="start", vehicle="a"),
            point(2, 0, role="goal", vehicle="a"),
            line("LineString", [place(0, -20), place(0, 20)], role="obstacle"),
            polygon([(-6, -22), (6, -22), (6, 30), (-6, 30)], role="area"),
        ],
    }
    scenario = import_scenario(written(tmp_path, content)).scenario
    # 2.2 km south to the wall's end, past it and back, at 1 m/s.
    assert scenario.horizon * scenario.dt > 1.2 * 2 * 20 * 111.0
