from __future__ import annotations

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.geodesy import Origin, to_geodetic, to_local
from radmpc.io.export.origin import Placement

MILLIMETER = 1e-3
PLACES = [
    Origin(0.0, 0.0, 0.0),
    Origin(54.1234, 12.0987, 38.25),
    Origin(-33.86, 151.2, -20.0),
    Origin(64.1, -21.9, 4500.0),
    Origin(-17.0, 180.0, 0.0),
    Origin(89.9999, -60.0, 10.0),
    Origin(-90.0, 0.0, 2800.0),
]


def cloud(seed: int, reach: float = 10_000.0) -> np.ndarray:
    """Points up to 10 km around the origin, and the origin."""
    points = np.random.default_rng(seed).uniform(-reach, reach, (200, 3))
    return np.vstack([points, np.zeros((1, 3)), [[reach, 0.0, 0.0]]])


@pytest.mark.parametrize("origin", PLACES)
def test_there_and_back_is_within_a_millimeter(origin: Origin) -> None:
    local = cloud(1)
    assert np.abs(to_local(to_geodetic(local, origin), origin) - local).max() < MILLIMETER


def test_far_above_the_ground_the_way_back_is_as_exact() -> None:
    origin = Origin(45.0, 7.0, 1e5)
    local = cloud(4, 1e5)
    assert np.abs(to_local(to_geodetic(local, origin), origin) - local).max() < 1e-6


@pytest.mark.parametrize("altitude", [0.0, 120.0])
def test_a_wide_plane_keeps_its_height_and_its_coordinates(altitude: float) -> None:
    origin = Origin(54.1234, 12.0987, 38.25)
    plane = cloud(5, 90_000.0)[:, :2]
    places = Placement(origin, altitude).geodetic(plane)
    assert set(places[:, 2]) == {38.25 + altitude}
    assert np.abs(to_local(places, origin)[:, :2] - plane).max() < MILLIMETER


@pytest.mark.parametrize("origin", PLACES)
def test_the_origin_is_its_own_place(origin: Origin) -> None:
    (place,) = to_geodetic(np.zeros((1, 3)), origin)
    assert place[0] == pytest.approx(origin.latitude, abs=1e-9)
    assert place[2] == pytest.approx(origin.height, abs=1e-6)
    if abs(origin.latitude) < 90.0:
        turn = (place[1] - origin.longitude + 180.0) % 360.0 - 180.0
        assert turn == pytest.approx(0.0, abs=1e-9)


def test_a_step_east_north_and_up_goes_there() -> None:
    origin = Origin(45.0, 7.0, 100.0)
    east, north, up = to_geodetic(100.0 * np.eye(3), origin)
    assert east[1] > 7.0
    assert east[0] == pytest.approx(45.0, abs=1e-6)
    assert north[0] > 45.0
    assert north[1] == pytest.approx(7.0)
    assert up[2] == pytest.approx(200.0)


@pytest.mark.parametrize("origin", PLACES)
def test_pymap3d_finds_the_same_places(origin: Origin) -> None:
    pymap3d = pytest.importorskip("pymap3d")
    local = cloud(2)
    lat, lon, height = pymap3d.enu2geodetic(
        *local.T, origin.latitude, origin.longitude, origin.height
    )
    ours = to_geodetic(local, origin)
    # At a pole all longitudes are one place: compare places, not numbers.
    theirs = np.column_stack([lat, lon, height])
    assert np.abs(to_local(theirs, origin) - to_local(ours, origin)).max() < MILLIMETER
    assert np.abs(ours[:, 0] - lat).max() < 1e-9
    assert np.abs(ours[:, 2] - height).max() < MILLIMETER


@pytest.mark.parametrize("origin", PLACES)
def test_proj_finds_the_same_local_coordinates(origin: Origin) -> None:
    pyproj = pytest.importorskip("pyproj")
    pipeline = pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad "
        "+step +proj=cart +ellps=WGS84 +step +proj=topocentric +ellps=WGS84 "
        f"+lon_0={origin.longitude} +lat_0={origin.latitude} +h_0={origin.height}"
    )
    local = cloud(3)
    lat, lon, height = to_geodetic(local, origin).T
    theirs = np.column_stack(pipeline.transform(lon, lat, height))
    assert np.abs(theirs - local).max() < MILLIMETER


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ((90.1, 0.0), "latitude: must lie between -90 and 90°, got 90.1"),
        ((0.0, -181.0), "longitude: must lie between -180 and 180°, got -181.0"),
        ((0.0, 0.0, 1e6), "height: must lie between -100000 and 100000 m"),
        ((float("nan"), 0.0), "latitude: must lie"),
    ],
)
def test_what_is_no_place_is_refused(numbers: tuple[float, ...], expected: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        Origin(*numbers)
    assert expected in str(caught.value)
