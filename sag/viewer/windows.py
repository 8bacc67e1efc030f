"""Windows of a data set as a page shows them, with motions that continue them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float
from PIL import Image
from scipy.ndimage import binary_dilation
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.scoring.judged import Judged
from sag.types import Batch
from sag.viewer.figures import figures_of, touched_points
from sag.viewer.shown import ShownMotion, ShownRow, ShownScene, ShownWindow


def shown_window(
    data: MotionDataModule, batch: Batch, motions: Mapping[str, Float[Tensor, "k t j 3"]], judge: bool = True
) -> ShownWindow:
    """A test window with its scene, the recorded motion and those of each row, judged.

    Args:
        data: where the window comes from.
        batch: the window alone, with its depth cloud where the data set has one.
        motions: of each row by its name, metres, camera frame of frame 0; the recorded motion is shown beside those
            that are as long.
        judge: off leaves figures and touched points out.

    Raises:
        SagError: not one window.
    """
    if len(batch) != 1:
        raise SagError(f"a window is shown by itself, and {len(batch)} were given")
    window = int(batch.index[0])
    picture, intrinsics = data.picture_with_camera(window)
    truth = _judged(data, batch, batch.motion.joints[0])
    lengths = {samples.shape[1] for samples in motions.values()}
    followed = data.recorded and lengths == {batch.motion.joints.shape[1]}
    pose = batch.world2cam[0].double().cpu().numpy()
    level = float(truth.world[0, 0, data.skeleton.feet, 2].min()) - data.ankle_height
    return ShownWindow(
        name=f"{data.name} {window}",
        picture=picture,
        intrinsics=intrinsics,
        person=batch.scene.person[0].cpu().numpy(),
        rows=tuple(
            ShownRow(name, tuple(_motion(_judged(data, batch, joints), judge, off=followed) for joints in samples))
            for name, samples in motions.items()
        ),
        truth=_motion(truth, judge, off=False) if followed else None,
        scene=_scene(batch),
        up=tuple(pose[:3, 2].tolist()),
        floor=level + float(pose[:3, 2] @ pose[:3, 3]),
        guessed=not data.recorded,
    )


def _judged(data: MotionDataModule, batch: Batch, joints: Float[Tensor, "t j 3"]) -> Judged:
    return Judged(batch, joints[None, None].to(batch.motion.start), data, None)


def _motion(judged: Judged, judge: bool, off: bool) -> ShownMotion:
    if not judge:
        return ShownMotion(judged.joints[0].cpu().numpy())
    figures = figures_of(judged, off)
    touched = touched_points(judged)
    return ShownMotion(judged.joints[0].cpu().numpy(), figures, None if touched is None else touched.cpu().numpy())


def _scene(batch: Batch) -> ShownScene | None:
    """Surfaces by the depth cloud, or by the picture's own depth where there is none."""
    cloud = batch.cloud
    person = batch.scene.person[0].cpu().numpy()
    if cloud is None:
        depth, intrinsics = batch.scene.depth[0].cpu().numpy(), batch.scene.intrinsics[0]
        depth = np.where(person, 0, depth)
    else:
        depth, intrinsics = cloud.depth[0].cpu().numpy(), cloud.intrinsics[0]
    if not (depth > 0).any():
        return None
    return ShownScene(depth, intrinsics.double().cpu().numpy(), _hidden(batch, person, depth, intrinsics))


def _hidden(batch: Batch, person: Bool[np.ndarray, "r c"], depth: np.ndarray, intrinsics: Tensor) -> np.ndarray:
    """Where the person stands in the pixels of the depth, whose camera may see more than the picture."""
    own, wide = (matrix.double().cpu().numpy() for matrix in (batch.scene.intrinsics[0], intrinsics))
    scale = own[0, 0] / wide[0, 0]
    left, top = ((np.array([0.5, 0.5]) - wide[:2, 2]) * scale + own[:2, 2]).tolist()
    size = (depth.shape[1], depth.shape[0])
    shift = (scale, 0, left - 0.5 * scale, 0, scale, top - 0.5 * scale)
    mask = Image.fromarray(person).convert("L").transform(size, Image.Transform.AFFINE, shift)
    wider = 2 + int(np.ceil(1 / scale))  # a pixel of the picture, on whose rim the cloud is finer
    return binary_dilation(np.asarray(mask) > 0, iterations=wider) & (depth == 0)
