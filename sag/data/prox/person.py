"""The person in a picture of PROX: where, and how far away.

The scan has no person in it, and of the body only the joints are known here: so the body is capsules around the bones,
and its outline is the mask that PROX keeps beside the picture.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sag.data.pictures import read_grey
from sag.data.prox.sensor import Aligned
from sag.errors import SagError

NOBODY = 255
"""Value of the masks where no person is."""


def read_mask(path: Path) -> Bool[np.ndarray, "h w"]:
    """Where a person is, unmirrored; of `BodyIndexColor` in the colour camera's pixels, of `BodyIndex` in the depth's.

    Raises:
        SagError: the file is damaged.
    """
    return read_grey(path)[:, ::-1] != NOBODY


def mask_of(folder: Path, stem: str, size: tuple[int, int], measured: Aligned) -> Bool[np.ndarray, "h w"] | None:
    """Where the person is in a colour picture, unmirrored, as PROX's masks say; nothing where it has none.

    Args:
        folder: of the recording.
        stem: name of the frame.
        size: rows and columns of the colour picture.
        measured: the frame's aligned depth, by which the depth camera's mask can be moved.

    Raises:
        SagError: a mask is damaged or of another size than its picture.
    """
    own = folder / "BodyIndexColor" / f"{stem}.png"
    if own.is_file():
        mask = read_mask(own)
        if mask.shape != size:
            raise SagError(f"{own} has {mask.shape} pixels, and its colour picture {size}; restore the original file")
        return mask
    moved = folder / "BodyIndex" / f"{stem}.png"
    if not moved.is_file() or (measured.source < 0).all():
        return None
    flat = read_mask(moved).ravel()
    if len(flat) <= measured.source.max():
        raise SagError(f"{moved} is smaller than the frame's Depth picture; restore the original file")
    return np.where(measured.source >= 0, flat[measured.source], False)


def with_person(
    scene: Float[np.ndarray, "h w"], body: Float[np.ndarray, "h w"], mask: Bool[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Depth of the scene with the person before it, metres.

    Inside the mask but beside the capsules the body is as far away as where it is nearest in the picture; it is never
    behind the scene, since it is seen.

    Args:
        scene: without the person, 0 where it is not known.
        body: of the capsules, infinite beside them.
        mask: where the person is seen; it touches the capsules.
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    box = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    inside, seen = mask[box], mask[box] & np.isfinite(body[box])
    nearest = distance_transform_edt(~seen, return_distances=False, return_indices=True)
    behind = np.where(scene[box] > 0, scene[box], np.inf)
    depth = scene.copy()
    depth[box][inside] = np.minimum(body[box][tuple(nearest)], behind)[inside]
    return depth
