"""Motions to export, and an animated file played by another library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pygltflib
from scipy.spatial.transform import Rotation

from sag.export.rig import rig_of
from sag.skeleton import GTA_IM_19, Skeleton


def rigid_motion(skeleton: Skeleton = GTA_IM_19, frames: int = 7, turn: float = 0.6) -> np.ndarray:
    """(t, j, 3) people whose bones turn at random and keep their lengths, metres, Y up."""
    generator = np.random.default_rng(0)
    rig = rig_of(skeleton, generator.uniform(0.1, 0.4, len(skeleton.bones)), split=True)
    steps = np.tile(rig.offsets, (frames, 1, 1))
    steps[:, 0] = np.cumsum(generator.normal(0, 0.05, (frames, 3)), axis=0) + [0.5, 0.9, -3]
    turns = np.cumsum(generator.normal(0, turn, (frames, len(rig.names), 3)), axis=0)
    places = rig.posed(steps, Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix().reshape(frames, -1, 3, 3))
    return places[:, [rig.names.index(name) for name in skeleton.joints]]


def stretching_motion(skeleton: Skeleton = GTA_IM_19, frames: int = 7) -> np.ndarray:
    """(t, j, 3) the same with every joint off by some centimetres, as generated ones are."""
    return rigid_motion(skeleton, frames) + np.random.default_rng(1).normal(0, 0.03, (frames, len(skeleton.joints), 3))


class PlayedGlb:
    """A GLB file as a program plays it, read by pygltflib.

    Attributes:
        times: of the keys, seconds.
        matrices: (t, n, 4, 4) of the nodes in the scene at each key.
    """

    def __init__(self, path: Path) -> None:
        self.file = pygltflib.GLTF2().load(str(path))
        (animation,) = self.file.animations
        self.times = self.array(animation.samplers[0].input)
        local = np.tile(np.eye(4), (len(self.times), len(self.file.nodes), 1, 1))
        outputs = [self.array(sampler.output) for sampler in animation.samplers]
        moved = {(c.target.node, c.target.path): outputs[c.sampler] for c in animation.channels}
        for number, node in enumerate(self.file.nodes):
            turns = moved.get((number, "rotation"), np.array([node.rotation or [0, 0, 0, 1]]))
            local[:, number, :3, :3] = Rotation.from_quat(turns).as_matrix()
            local[:, number, :3, 3] = moved.get((number, "translation"), np.array([node.translation or [0, 0, 0]]))
        self.matrices = local.copy()
        for number, node in enumerate(self.file.nodes):  # parents stand before their children
            for child in node.children or []:
                assert child > number
                self.matrices[:, child] = self.matrices[:, number] @ local[:, child]

    def array(self, number: int) -> np.ndarray:
        """An accessor's numbers."""
        accessor = self.file.accessors[number]
        view = self.file.bufferViews[accessor.bufferView]
        kind = {5126: np.float32, 5121: np.uint8, 5123: np.uint16, 5125: np.uint32}[accessor.componentType]
        shape = {"SCALAR": (), "VEC2": (2,), "VEC3": (3,), "VEC4": (4,), "MAT4": (4, 4)}[accessor.type]
        count = accessor.count * int(np.prod(shape, dtype=int))
        found = np.frombuffer(self.file.binary_blob(), kind, count, view.byteOffset).reshape(accessor.count, *shape)
        return found.swapaxes(1, 2) if accessor.type == "MAT4" else found

    def node(self, name: str) -> int:
        """Number of the node of that name."""
        return next(number for number, node in enumerate(self.file.nodes) if node.name == name)

    def joints(self, skeleton: Skeleton) -> np.ndarray:
        """(t, j, 3) places of a skeleton's joints at each key."""
        return self.matrices[:, [self.node(name) for name in skeleton.joints]][..., :3, 3]

    def body(self) -> np.ndarray:
        """(t, v, 3) vertices of the skinned mesh at each key."""
        node = self.file.nodes[self.node("body")]
        skin, primitive = self.file.skins[node.skin], self.file.meshes[node.mesh].primitives[0]
        carried = self.matrices[:, skin.joints] @ self.array(skin.inverseBindMatrices)
        places, carriers, weights = (
            self.array(getattr(primitive.attributes, name)) for name in ("POSITION", "JOINTS_0", "WEIGHTS_0")
        )
        blended = np.einsum("vk,tvkij->tvij", weights / 255, carried[:, carriers])
        return np.einsum("tvij,vj->tvi", blended[..., :3, :3], places) + blended[..., :3, 3]
