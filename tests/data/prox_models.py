"""A body model of SMPL-X's layout, made of a few numbers: a joint is a vertex of its own, and nothing is bent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from prox_files import body

from sag.data.prox.bodies import JOINTS, LANDMARKS, VERTICES
from sag.data.prox.fits import SMPLX_JOINTS
from sag.skeleton import PROX_16

PARENTS = [
    -1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 15, 15, 15,
    *(joint for wrist, first in ((20, 25), (21, 40)) for finger in range(5)
      for joint in (wrist, first + 3 * finger, first + 3 * finger + 1)),
]  # fmt: skip
"""Each joint's parent."""


def arrays() -> dict[str, np.ndarray]:
    """What a model holds; what it does not need is an array of objects, as in the original."""
    template = np.zeros((VERTICES, 3))
    template[[SMPLX_JOINTS[name] for name in PROX_16.joints]] = body()
    shapes = np.zeros((VERTICES, 3, 20), np.float16)
    shapes[:JOINTS, 1, 0] = 0.125  # the first number of a shape makes everything higher
    parents = np.array([PARENTS, range(JOINTS)], np.int64)
    return {
        "v_template": template,
        "shapedirs": shapes,
        "posedirs": np.zeros((VERTICES, 3, 9 * (JOINTS - 1)), np.float16),
        "J_regressor": np.eye(JOINTS, VERTICES),
        "weights": np.eye(JOINTS)[np.arange(VERTICES) % JOINTS],
        "hands_componentsl": np.eye(45), "hands_componentsr": np.eye(45),
        "hands_meanl": np.full(45, 0.1), "hands_meanr": np.full(45, 0.1),
        "lmk_bary_coords": np.full((LANDMARKS, 3), 1 / 3),
        "f": np.zeros((20_908, 3), np.uint32),
        "kintree_table": parents.astype(np.uint32),
        "lmk_faces_idx": np.arange(LANDMARKS),
        "joint2num": np.array({"Pelvis": 0}, object),
    }  # fmt: skip


def write_model(path: Path, **changes: object) -> Path:
    """Writes a model with other arrays; nothing takes one away."""
    content = {**arrays(), **changes}
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(path, **{name: array for name, array in content.items() if array is not None})
    return path
