import json
from pathlib import Path

import numpy as np
import pytest
from prox_files import Take, module, write_root

from sag.errors import SagError
from sag.types import FRAMES


@pytest.fixture
def root(tmp_path) -> Path:
    """A data set of two scenes with a recording each."""
    root = write_root(tmp_path / "root")
    for name in ("N0Sofa_00034_01", "MPH16_00157_01"):
        Take(FRAMES).write(root, name)
    return root


TURNED = [[2.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
COLOUR = {"camera_mtx": [[106, 0, 95], [0, 106, 53], [0, 0, 1]], "k": [0] * 5, "view_mtx": np.eye(4)[:3].tolist()}

DAMAGED = {
    "no json": ("calibration/Color.json", "{"),
    "no object": ("calibration/Color.json", "[]"),
    "deep": ("calibration/Color.json", "[" * 100_000),
    "large": ("calibration/Color.json", " " * (1 << 21)),
    "negative focal length": ("calibration/Color.json", {**COLOUR, "camera_mtx": [[-1, 0, 9], [0, 1, 9], [0, 0, 1]]}),
    "no number": ("calibration/Color.json", {**COLOUR, "camera_mtx": [[float("nan"), 0, 9], [0, 1, 9], [0, 0, 1]]}),
    "axis outside": ("calibration/Color.json", {**COLOUR, "camera_mtx": [[900, 0, 951], [0, 900, 536], [0, 0, 1]]}),
    "text": ("calibration/Color.json", {**COLOUR, "k": "none"}),
    "stretched": ("calibration/IR.json", {**COLOUR, "view_mtx": TURNED}),
    "singular": ("cam2world/MPH16.json", np.zeros((4, 4)).tolist()),
    "mirrored": ("cam2world/MPH16.json", np.diag([-1.0, 1, 1, 1]).tolist()),
    "3 x 4": ("cam2world/MPH16.json", np.eye(4)[:3].tolist()),
    "ragged": ("cam2world/MPH16.json", [[1], [1, 2]]),
    "no mesh": ("scenes/MPH16.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
    "no triangles": ("scenes/MPH16.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_file_is_named_in_one_line(root, tmp_path, name):
    path, content = DAMAGED[name]
    (root / path).write_text(content if isinstance(content, str) else json.dumps(content))
    with pytest.raises(SagError, match=path) as refused:
        module(root, tmp_path).build()
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("path", ["calibration/IR.json", "cam2world/N0Sofa.json"])
def test_a_missing_file_is_named(root, tmp_path, path):
    (root / path).unlink()
    with pytest.raises(SagError, match=path):
        module(root, tmp_path).build()
