"""Penetration: how often and how deep bodies are inside furniture and walls that are known; ours, not the paper's."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.plotted import PlottedMetric
from sag.types import GENERATED, KnownGeometry

SPACING = 0.05
"""Greatest distance between samples along a bone, metres."""


def deepest_penetration(
    world: Float[Tensor, "t j 3"], bones: np.ndarray | Sequence[Sequence[int]], geometry: KnownGeometry
) -> Float[Tensor, " t"]:
    """How deep the deepest point of the bones' axes is inside furniture or a wall at each frame, metres; 0 outside.

    Bones are sampled at least every 5 cm. A signed distance changes by no more than the way, so a bone whose ends are
    together farther out than it is long lies outside and is not sampled: exact, and most of the time.

    Args:
        world: joints, metres, world frame (z up).
        bones: places of the two joints of each bone.
        geometry: the scene, known.

    Example:
        >>> import torch
        >>> from sag.data.rooms.geometry import RoomGeometry, Solid
        >>> table = Solid("table", centre=(0.0, 0.0, 0.5), half=(0.4, 0.4, 0.5), yaw=0.0)
        >>> room = RoomGeometry((4.0, 4.0, 2.5), floor=(), solids=(table,))
        >>> arm = torch.tensor([[[-1.0, 0.0, 0.9], [1.0, 0.0, 0.9]], [[-1.0, 0.0, 1.1], [1.0, 0.0, 1.1]]])
        >>> deepest_penetration(arm, [(0, 1)], room).round(decimals=3)
        tensor([0.1000, 0.0000], dtype=torch.float64)
    """
    joints = world.double().cpu().numpy()
    deepest = -geometry.signed_distance(joints)
    starts, ends = np.asarray(bones).T
    length = np.linalg.norm(joints[:, starts] - joints[:, ends], axis=-1)
    frame, bone = np.nonzero(-deepest[:, starts] - deepest[:, ends] < length)
    within = deepest[:, np.unique(bones)].max(axis=1).clip(0)
    owner, points = _inner_points(joints[frame, starts[bone]], joints[frame, ends[bone]])
    np.maximum.at(within, frame[owner], -geometry.signed_distance(points))
    return torch.from_numpy(within).to(world.device)


def _inner_points(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Evenly spaced points between two joints, as many as each bone needs, and the bone that each is of."""
    length = np.linalg.norm(ends - starts, axis=-1)
    pieces = np.ceil(length / SPACING).astype(int).clip(1)
    owner = np.arange(len(pieces)).repeat(pieces - 1)
    first = np.cumsum(pieces - 1) - (pieces - 1)
    share = ((np.arange(len(owner)) - first[owner] + 1) / pieces[owner])[:, None]
    return owner, (1 - share) * starts[owner] + share * ends[owner]


class Penetration(PlottedMetric):
    """How often and how deep generated bodies are inside furniture or walls whose geometry is known. Ours.

    share = mean [p_t > tolerance], root = mean [signed distance of the root < -tolerance], depth = mean p_t (metres)

    over generated frames, where p_t is the depth of the deepest point of the bones' axes below the nearest surface
    (0 outside). Axes, not capsules: flesh may touch. Unlike the non-collision ratio it needs no point cloud and knows
    what the camera does not see.

    Reacts to bodies in furniture and walls. Blind to the floor (see `FloorError`), to jitter in free space, and to
    near misses. True motions are not at 0 where people sit and lean: print their value beside it. A method that stays
    where it starts scores well, so set it against the same motions in other scenes.

    Args:
        bones: places of the two joints of each bone.
        root: place of the root joint.
        tolerance: depth up to which a frame is clear, metres; `depth` is not affected.
        every: frames from one that is judged to the next; 1 judges all 64.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.penetration import Penetration
        >>> from sag.data.rooms.geometry import RoomGeometry
        >>> room = RoomGeometry((4.0, 4.0, 2.5), floor=())
        >>> metric = Penetration(bones=[(0, 1)], root=0)
        >>> metric.update(torch.tensor([[1.5, 0.0, 1.0], [2.1, 0.0, 1.0]]).expand(1, 65, 2, 3), geometry=[room])
        >>> {name: round(float(value), 3) for name, value in metric.compute().items()}
        {'share': 1.0, 'root': 0.0, 'depth': 0.1}
    """

    higher_is_better = False
    title = "penetration"

    totals: Tensor
    frames: Tensor

    def __init__(
        self,
        bones: np.ndarray | Sequence[Sequence[int]],
        root: int,
        tolerance: float = 0.0,
        every: int = 1,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not 1 <= every <= GENERATED:
            raise SagError(f"every of {self.title} must lie in 1 .. {GENERATED}, not {every}")
        self.bones = [(int(start), int(end)) for start, end in bones]
        self.root, self.tolerance, self.every = root, tolerance, every
        self._keep_settings(tolerance, every, root, *(joint for bone in self.bones for joint in bone))
        self.add_state("totals", torch.zeros(3, dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("frames", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, world: Float[Tensor, "b t j 3"], geometry: Sequence[KnownGeometry]) -> None:
        """Adds motions.

        Args:
            world: joints, 65 frames, metres, world frame (z up); the given frame 0 is left out.
            geometry: of the scene of each motion.

        Raises:
            SagError: joints and bones do not fit, not one geometry for each motion, or a coordinate that is not finite.
        """
        check_joints(self.title, world, max(self.root, *(joint for bone in self.bones for joint in bone)) + 1)
        if len(geometry) != len(world):
            raise SagError(f"{self.title} was given {len(world)} motions but {len(geometry)} scenes")
        judged = world[:, 1 :: self.every]
        for scene, rows in _by_scene(geometry):
            motions = judged[rows].flatten(0, 1)
            depth = deepest_penetration(motions, self.bones, scene)
            root = -scene.signed_distance(motions[:, self.root].double().cpu().numpy())
            inside, root_inside = (depth > self.tolerance).sum(), torch.from_numpy(root > self.tolerance).sum()
            added = torch.stack([inside, root_inside.to(inside), depth.sum()])
            self.totals = self.totals + added.to(self.totals)
            self.frames = self.frames + len(depth)

    def compute(self) -> dict[str, Tensor]:
        """Shares of frames with a bone (`share`) and the root (`root`) inside, and the mean `depth` in metres.

        Raises:
            SagError: no motion was given.
        """
        self._require(self.frames)
        return dict(zip(("share", "root", "depth"), self.totals / self.frames))


def _by_scene(geometry: Sequence[KnownGeometry]) -> Iterator[tuple[KnownGeometry, list[int]]]:
    """Each scene with the places of its motions, so that all of them are asked for at once."""
    places: dict[int, list[int]] = {}
    for place, scene in enumerate(geometry):
        places.setdefault(id(scene), []).append(place)
    return ((geometry[found[0]], found) for found in places.values())
