"""What the cache stores of a window, whatever its data set: recentred picture and depth cloud."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8, UInt16
from scipy.ndimage import binary_dilation

from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.recordings.filters import Limits
from sag.data.resampling import Box, area_averaged, nearest
from sag.geometry.camera import recentred


@dataclass(frozen=True)
class Picture:
    """What the camera saw in one frame, at native resolution.

    Attributes:
        colour: colours.
        depth: planar z, metres, 0 where it is not known.
        ids: 24-bit numbers of instances, 0 is the background.
        intrinsics: camera matrix in pixels of this picture.
    """

    colour: UInt8[np.ndarray, "h w 3"]
    depth: Float[np.ndarray, "h w"]
    ids: Int[np.ndarray, "h w"]
    intrinsics: Float[np.ndarray, "3 3"]


@dataclass(frozen=True)
class WindowFormat:
    """How windows are stored.

    Attributes:
        joints: places of the skeleton's joints among those of the files.
        root: place of the skeleton's root among the skeleton's joints; windows are centred on it.
        image_size: rows and columns of the picture.
        cloud_step: of the native picture every so many rows and columns go to the cloud.
        limits: what a window must keep to.
    """

    joints: list[int]
    root: int
    image_size: tuple[int, int]
    cloud_step: int
    limits: Limits

    @property
    def root_place(self) -> int:
        """Place of the skeleton's root among the joints of the files."""
        return self.joints[self.root]

    def cloud_size(self, rows: int, columns: int) -> tuple[int, int]:
        """Rows and columns of the cloud of a native picture."""
        first, step = self.cloud_step // 2, self.cloud_step
        return len(range(first, rows, step)), len(range(first, columns, step))


def window_arrays(
    picture: Picture,
    person: int,
    joints: Float[np.ndarray, "t j 3"],
    world2cam: Float[np.ndarray, "4 4"],
    form: WindowFormat,
    cloud: Picture | None,
) -> dict[str, np.ndarray]:
    """The cache's arrays of one window by name.

    Args:
        picture: of the start frame.
        person: the person's id in it.
        joints: all those of the files, metres, camera frame of the start frame.
        world2cam: of the start frame, column vectors, metres.
        form: how windows are stored.
        cloud: what the cloud is made of; nothing where none is wanted.
    """
    window = {"joints": joints[:, form.joints], "world2cam": world2cam}
    window |= centred_picture(picture, joints[0, form.root_place], person, form)
    return window | (depth_cloud(cloud, person, form) if cloud else {})


def centred_picture(
    picture: Picture, root: Float[np.ndarray, " 3"], person: int, form: WindowFormat
) -> dict[str, np.ndarray]:
    """Picture, depth, ids and intrinsics with the start root (metres, camera frame) at the centre."""
    rows, columns = form.image_size
    scale = columns / picture.depth.shape[1]
    native = torch.from_numpy(picture.intrinsics)[None]
    intrinsics = recentred(native, torch.from_numpy(root)[None], form.image_size, scale)[0].numpy()
    left, top = (picture.intrinsics[:2, 2] * scale - intrinsics[:2, 2]) / scale
    box: Box = (left, top, left + columns / scale, top + rows / scale)
    return {
        "image": area_averaged(picture.colour, box, form.image_size),
        "depth": stored_depth(nearest(picture.depth, box, form.image_size), form.limits),
        "ids": small_ids(nearest(picture.ids, box, form.image_size), person),
        "intrinsics": intrinsics,
    }


def depth_cloud(picture: Picture, person: int, form: WindowFormat) -> dict[str, np.ndarray]:
    """Uncropped depth without the person, and its intrinsics.

    The person's mask is widened by a pixel: at its rim a pixel can hold depth and id of different surfaces.
    """
    step, first = form.cloud_step, form.cloud_step // 2
    scene: Bool[np.ndarray, "h w"] = ~binary_dilation(picture.ids == person, np.ones((3, 3)))
    intrinsics = picture.intrinsics.copy()
    intrinsics[:2] /= step
    # The centre of the cloud's first pixel is the centre of the native pixel that it takes.
    intrinsics[:2, 2] += 0.5 - (first + 0.5) / step
    depth = stored_depth(np.where(scene, picture.depth, 0)[first::step, first::step], form.limits)
    return {"cloud_depth": depth, "cloud_intrinsics": intrinsics}


def stored_depth(depth: Float[np.ndarray, "h w"], limits: Limits) -> UInt16[np.ndarray, "h w"]:
    """Depth (metres) in steps of `DEPTH_UNIT`, 0 beyond the farthest."""
    return np.rint(np.where(depth <= limits.farthest_depth, depth, 0) / DEPTH_UNIT).astype(np.uint16)


def small_ids(ids: Int[np.ndarray, "h w"], person: int) -> UInt8[np.ndarray, "h w"]:
    """Ids in a byte: 0 stays, the person is `PERSON`, the others count from 1 and share the last beyond 254."""
    others = np.setdiff1d(ids, [0, person])
    places = np.minimum(np.searchsorted(others, ids) + 1, PERSON - 1)
    return np.select([ids == 0, ids == person], [0, PERSON], places).astype(np.uint8)
