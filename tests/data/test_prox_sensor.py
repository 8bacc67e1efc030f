from pathlib import Path

import numpy as np
import pytest
from prox_files import COLUMNS, INFRARED_VIEW, ROWS, WALL, encoded, measured, write_root

from sag.data.prox.calibration import Lens, Sensor
from sag.data.prox.sensor import aligned, read_depth


@pytest.fixture
def sensor(tmp_path) -> Sensor:
    return Sensor.read(write_root(tmp_path / "root"))


def test_measured_depth_comes_to_the_colour_camera(tmp_path, sensor):
    path = tmp_path / "depth.png"
    path.write_bytes(encoded(measured(), "PNG"))
    depth = read_depth(path)
    np.testing.assert_allclose(depth, measured() / 8000)
    found = aligned(depth, sensor, (ROWS, COLUMNS))
    assert np.abs(found.depth[found.source >= 0] - WALL).max() < 1e-3
    assert (found.depth[10:-10, 40:-40] > 0).all(), "no gaps between the splats"


def test_of_several_points_the_nearest_is_seen(sensor):
    depth = measured() / 8000
    depth[30:50, 40:60] = 2.0
    found = aligned(depth, sensor, (ROWS, COLUMNS))
    near = np.abs(found.depth - 2.0) < 0.1
    assert 60**2 * 0.7 < near.sum() < 63**2 * 1.3
    rows, columns = np.nonzero(near)
    assert near[rows.min() + 2 : rows.max() - 2, columns.min() + 2 : columns.max() - 2].all(), "the wall shows through"


def test_lens_distortion_is_taken_back(sensor):
    straight = np.array([[0.3, -0.2], [-0.5, 0.4], [0.0, 0.1]])
    k1, k2, p1, p2, k3 = distortion = np.array([0.09, -0.27, 0.001, -0.002, 0.1])
    x, y = straight.T
    r = x**2 + y**2
    radial = 1 + k1 * r + k2 * r**2 + k3 * r**3
    bent = np.stack(
        [x * radial + 2 * p1 * x * y + p2 * (r + 2 * x**2), y * radial + p1 * (r + 2 * y**2) + 2 * p2 * x * y], -1
    )
    lens = Lens(Path("IR.json"), sensor.infrared.intrinsics, distortion, *INFRARED_VIEW)
    pixels = bent * [36.5, 36.5] + lens.intrinsics[:2, 2]
    np.testing.assert_allclose(lens.rays(pixels)[:, :2], straight, atol=1e-9)
