"""Motions that a method draws for some windows, ready to be filmed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.data.selection import spread
from sag.export.upright import Upright, up_of
from sag.files import write_whole
from sag.film.stage import Stage, stage_of
from sag.film.strip import side_by_side, strip
from sag.methods.base import Method
from sag.types import Batch

SHEET = "samples.png"
"""Name of a run's contact sheet, in its folder."""

SHEET_WINDOWS, SHEET_COLUMNS, SHEET_COLOURS = 4, 240, 128
"""Windows on a sheet, the columns of each, and the colours of all: some 60 kB."""


def spread_windows(data: MotionDataModule, split: str, count: int) -> list[int]:
    """Places in the data set of so many windows of a split, evenly spread; of all where it has fewer."""
    known = data.cache.rows(split).tolist()
    return spread(known, min(count, len(known)))


@torch.no_grad()
def sampled(method: Method, batch: Batch, samples: int, seed: int) -> Float[Tensor, "b k t j 3"]:
    """Motions for each window, metres, camera frame of frame 0; the global state of chance stays as it is."""
    generator = torch.Generator(method.device).manual_seed(seed)
    drawn = method.samples(batch.to(method.device), samples, generator)
    return torch.stack([motion.joints for motion in drawn], dim=1).float().cpu()


def stages_of(
    data: MotionDataModule, batch: Batch, motions: Float[Tensor, "b k t j 3"], with_surface: bool = False
) -> list[Stage]:
    """Each window with the motions that continue it, and the place around them where it is needed."""
    stages = []
    for place, world2cam, joints in zip(batch.index.tolist(), batch.world2cam.double().numpy(), motions.numpy()):
        upright = Upright.at(joints[0, 0], data.skeleton, up_of(world2cam), data.ankle_height)
        stages.append(stage_of(joints, data.skeleton, data.fps, upright, data, place, with_surface))
    return stages


def write_sheet(path: Path, stages: Sequence[Stage]) -> None:
    """Writes a contact sheet: for each window a picture with poses of its motions, coloured by time."""
    sheet = side_by_side([strip(stage, 2 * SHEET_COLUMNS) for stage in stages], SHEET_COLUMNS)
    few = sheet.quantize(SHEET_COLOURS)
    write_whole(path, lambda file: few.save(file, "PNG", optimize=True))
