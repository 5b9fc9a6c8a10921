"""Plans as films."""

from __future__ import annotations

import os
import shutil
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from radmpc.errors import FileFormatError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Workspace
from radmpc.planners.paper.temporal import make_temporal_obstacle
from radmpc.plotting import animate_plan, save_animation
from radmpc.plotting.canvas.figure import drawn_box
from radmpc.plotting.interpolation import interpolated_path, moving_outline

from .conftest import HORIZON


def artist(ax: Axes, gid: str) -> object:
    [found] = [child for child in ax.get_children() if child.get_gid() == gid]
    return found


def drawn(film: object, frame: int) -> Axes:
    """The axes of a film at a frame."""
    film._draw_was_started = True  # it is looked at here, frame by frame
    film._func(frame)
    return film._fig.axes[0]


def test_a_long_name_of_a_scenario_ends_within_the_film(space_plan: Plan) -> None:
    # Low and wide, axes in space begin far from the left; small letters are cut finely.
    wide = Workspace(np.array([-40.0, -40.0, -5.0]), np.array([40.0, 40.0, 12.0]))
    scenario = replace(space_plan.scenario, name="i" * 300, workspace=wide)
    ax = drawn(animate_plan(replace(space_plan, scenario=scenario), frames_per_step=1), 0)
    ax.figure.draw_without_rendering()
    [title] = [t for t in ax.findobj(Text) if t.get_text().startswith("iii")]
    assert title.get_text().splitlines()[0].endswith("…")
    assert title.get_window_extent().x1 <= ax.figure.bbox.width


def test_a_low_and_wide_scene_in_space_takes_the_width_of_its_film(space_plan: Plan) -> None:
    wide = Workspace(np.array([-4.0, -2.0, 0.0]), np.array([16.0, 12.0, 10.0]))
    scenario = replace(space_plan.scenario, workspace=wide)
    ax = drawn(animate_plan(replace(space_plan, scenario=scenario), frames_per_step=1), 0)
    scene = drawn_box(ax)
    assert scene.width > 0.8 * ax.figure.bbox.width
    assert ax.figure.bbox.x0 <= scene.x0 < scene.x1 <= ax.figure.bbox.x1
    ax.figure.draw_without_rendering()
    heads = [t.get_window_extent() for t in ax.findobj(Text) if t.get_text().startswith("sky")]
    assert all(head.y0 > scene.y1 for head in heads)


def test_names_that_move_with_vehicles_stay_within_the_axes(flat_plan: Plan) -> None:
    vehicles = [
        replace(v, name=f"{v.name}, tender of the harbor master")
        for v in flat_plan.scenario.vehicles
    ]
    flown = [replace(t, name=v.name) for t, v in zip(flat_plan.trajectories, vehicles, strict=True)]
    scenario = replace(flat_plan.scenario, vehicles=vehicles, keep=(), obstacles=())
    sets = tuple((v.name,) for v in vehicles)
    plan = replace(flat_plan, scenario=scenario, sets=sets, trajectories=flown, couplings=())
    film = animate_plan(plan, frames_per_step=1)
    for frame in range(HORIZON + 1):
        ax = drawn(film, frame)
        ax.figure.draw_without_rendering()
        names = [t for t in ax.findobj(Text) if t.get_text().endswith("master")]
        assert len(names) == len(vehicles)
        boxes = [text.get_window_extent() for text in names]
        frame_of_all = ax.get_window_extent()
        assert all(box.x0 >= frame_of_all.x0 and box.x1 <= frame_of_all.x1 for box in boxes)


@pytest.mark.parametrize("dimension", [2, 3])
def test_names_keep_apart_where_vehicles_meet(
    flat_plan: Plan, space_plan: Plan, dimension: int
) -> None:
    plan = flat_plan if dimension == 2 else space_plan
    first, *others = plan.trajectories
    # All fly the same way, so that all names have the same place.
    flown = [first, *(replace(t, means=first.means) for t in others)]
    film = animate_plan(replace(plan, trajectories=flown), frames_per_step=1)
    names = [trajectory.name for trajectory in flown]
    for frame in range(HORIZON + 1):
        ax = drawn(film, frame)
        ax.figure.draw_without_rendering()
        shown = [t for t in ax.findobj(Text) if t.get_text() in names and t.get_visible()]
        assert len(shown) == min(len(names), 2 if dimension == 3 else 6)
        # They may touch: half a pixel each is rounding.
        boxes = [text.get_window_extent().padded(-0.5) for text in shown]
        assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def test_a_name_without_a_place_is_left_out_until_it_has_one(space_plan: Plan) -> None:
    trajectory, vehicle = space_plan.trajectories[0], space_plan.scenario.vehicles[0]
    names = ("one", "two", "six")
    fleet = [replace(vehicle, name=name) for name in names]
    away = np.array(trajectory.means)
    away[1:, 0] += 4.0
    means = (trajectory.means, trajectory.means, away)
    flown = [replace(trajectory, name=n, means=m) for n, m in zip(names, means, strict=True)]
    scenario = replace(space_plan.scenario, vehicles=fleet, keep=(), obstacles=())
    plan = replace(space_plan, scenario=scenario, trajectories=flown, sets=(names,), couplings=())
    film = animate_plan(plan, frames_per_step=1)
    for frame, is_shown in ((0, False), (HORIZON, True), (0, False)):
        [text] = [t for t in drawn(film, frame).findobj(Text) if t.get_text() == "six"]
        assert text.get_visible() is is_shown


def test_vehicles_are_where_the_plan_has_them_at_every_step(flat_plan: Plan) -> None:
    film = animate_plan(flat_plan, frames_per_step=3)
    for step in range(HORIZON + 1):
        ax = drawn(film, 3 * step)
        for trajectory in flat_plan.trajectories:
            hull = artist(ax, f"vehicle:{trajectory.name}")
            assert hull.center == pytest.approx(tuple(trajectory.means[step, :2]))
        assert artist(ax, "clock").get_text() == f"t = {float(step):.1f} s"


def test_the_regions_are_the_three_sigma_ellipses(flat_plan: Plan) -> None:
    film = animate_plan(flat_plan, frames_per_step=2)
    trajectory = flat_plan.trajectories[0]
    for step in range(HORIZON + 1):
        outline = artist(drawn(film, 2 * step), "ellipse:a").get_xy()
        away = outline - trajectory.means[step, :2]
        inverse = np.linalg.inv(trajectory.covariances[step][:2, :2])
        np.testing.assert_allclose(np.einsum("pa,ab,pb->p", away, inverse, away), 9.0, rtol=1e-9)


@pytest.mark.parametrize("intervals", [False, True])
def test_temporal_obstacles_are_those_of_the_planner(flat_plan: Plan, intervals: bool) -> None:
    vehicle, trajectory = flat_plan.scenario.vehicles[0], flat_plan.trajectories[0]
    path = interpolated_path(vehicle, trajectory, 1, intervals=intervals)
    planned = make_temporal_obstacle(
        vehicle,
        trajectory.means,
        trajectory.covariances,
        0,
        intervals=intervals,
        controls=trajectory.controls,
    )
    sagitta = np.linalg.norm(trajectory.controls @ vehicle.system.sagitta.T, axis=1)
    assert sagitta.max() > 0.1
    for step in range(0 if intervals else 1, HORIZON):
        normals, offsets = planned.at(step)
        reach = (normals @ path.boxes[step].T).max(axis=1)
        assert np.all(reach <= offsets + 1e-9)
        # Ten points of the curve per step miss its outermost by a hundredth of the sagitta at most.
        missed = 0.01 * sagitta[step] if intervals else 0.0
        assert np.all(reach >= offsets - missed - 1e-9)


def test_a_moving_obstacle_moves_between_steps_as_the_certificate_has_it(flat_plan: Plan) -> None:
    ferry = next(o for o in flat_plan.scenario.obstacles if o.name == "ferry")
    for time in (0.0, 0.4, 1.0, 2.75, 4.0):
        center = np.asarray(shapely.Polygon(moving_outline(ferry, time)).centroid.coords[0])
        np.testing.assert_allclose(center, [7.5 + time, 7.5], atol=1e-9)
    ax = drawn(animate_plan(flat_plan, frames_per_step=2), 3)
    assert artist(ax, "obstacle:ferry").get_xy()[:, 0].min() == pytest.approx(8.5)


def test_space_is_animated_too(space_plan: Plan) -> None:
    film = animate_plan(space_plan, frames_per_step=2)
    ax = drawn(film, 2 * HORIZON)
    x, y, z = artist(ax, "vehicle:up").get_data_3d()
    assert (x[0], y[0], z[0]) == pytest.approx(tuple(space_plan.trajectories[0].means[-1, :3]))


def test_a_film_is_drawn_on_given_axes(flat_plan: Plan) -> None:
    figure = Figure()
    ax = figure.add_subplot()
    film = animate_plan(flat_plan, ax, frames_per_step=1)
    assert drawn(film, 0) is ax


def test_a_notebook_shows_a_film_and_a_name_is_no_html(flat_plan: Plan) -> None:
    named = replace(flat_plan, scenario=replace(flat_plan.scenario, name='<b>&"'))
    film = animate_plan(named, frames_per_step=1)
    dpi = film._fig.dpi
    page = film._repr_html_()
    assert page.startswith('<img alt="&lt;b&gt;&amp;&quot;" src="data:image/gif;base64,')
    with Image.open(BytesIO(b64decode(page.split("base64,")[1].split('"')[0]))) as image:
        assert image.n_frames == HORIZON + 1
    assert film._fig.dpi == dpi


@pytest.mark.slow
def test_a_gif_holds_every_frame_and_lasts_as_long_as_it_should(
    flat_plan: Plan, tmp_path: Path
) -> None:
    save_animation(flat_plan, tmp_path / "bay.gif", frames_per_step=2)
    with Image.open(tmp_path / "bay.gif") as image:
        assert image.n_frames == 2 * HORIZON + 1
        assert image.info["duration"] == 250
        assert image.info["loop"] == 0
        first = np.asarray(image.convert("RGB"), dtype=int)
        assert first[0, 0].tolist() == [255, 255, 255]
        image.seek(HORIZON)
        assert (np.abs(np.asarray(image.convert("RGB"), dtype=int) - first) > 60).any()
    assert os.listdir(tmp_path) == ["bay.gif"]


def test_without_a_plan_a_film_is_one_picture_that_says_so(
    empty_plan: Plan, tmp_path: Path
) -> None:
    save_animation(empty_plan, tmp_path / "none.gif")
    with Image.open(tmp_path / "none.gif") as image:
        assert getattr(image, "n_frames", 1) == 1


def test_other_endings_are_refused_and_mp4_without_its_program(
    flat_plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FileFormatError, match=r"bay.avi: a film must end in .gif, .mp4"):
        save_animation(flat_plan, tmp_path / "bay.avi")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FileFormatError, match="needs the program ffmpeg"):
        save_animation(flat_plan, tmp_path / "bay.mp4")
    assert os.listdir(tmp_path) == []


@pytest.mark.slow
def test_an_mp4_is_read_back_by_a_player(
    flat_plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    player = pytest.importorskip("imageio_ffmpeg")
    bin_folder = tmp_path / "bin"
    bin_folder.mkdir()
    os.symlink(player.get_ffmpeg_exe(), bin_folder / "ffmpeg")
    monkeypatch.setenv("PATH", f"{bin_folder}{os.pathsep}{os.environ['PATH']}")
    assert shutil.which("ffmpeg")
    path = tmp_path / "bay.mp4"
    save_animation(flat_plan, path, frames_per_step=2)
    frames, seconds = player.count_frames_and_secs(str(path))
    assert frames == 2 * HORIZON + 1
    assert seconds == pytest.approx(frames / 4.0, rel=0.2)


def test_an_interrupted_film_leaves_the_old_file_and_nothing_else(
    flat_plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bay.gif"
    path.write_bytes(b"old")

    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Image.Image, "save", interrupt)
    with pytest.raises(KeyboardInterrupt):
        save_animation(replace(flat_plan), path, frames_per_step=1)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["bay.gif"]


@pytest.mark.filterwarnings("error")
def test_a_notebook_tells_of_letters_that_the_font_lacks_below_a_film_in_one_line(
    flat_plan: Plan,
) -> None:
    foreign = replace(flat_plan, scenario=replace(flat_plan.scenario, name="港の<i>"))
    page = animate_plan(foreign, frames_per_step=1)._repr_html_()
    told = "the font has no sign for の, 港: boxes stand for them"
    assert page.endswith(f"<p>{told}</p>")
    assert animate_plan(flat_plan, frames_per_step=1)._repr_html_().endswith("/>")
