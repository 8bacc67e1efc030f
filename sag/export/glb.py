"""GLB: bodies that move, the place around it and the camera that saw both, in one animated glTF 2.0 file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag import __version__
from sag.export.body import Body, body_of, rest_places, with_ends
from sag.export.checking import check_motion, check_suffix
from sag.export.gltf import INDICES, VERTICES, GltfDocument, numbered, numbers
from sag.export.rig import Rig, median_lengths, rig_of
from sag.export.surface import Surface, add_surface
from sag.files import write_whole, writing_in
from sag.skeleton import Skeleton
from sag.viewer.body import SAMPLE_COLOURS

SKIN = (0.06, 0.26, 0.62, 1.0)
"""Colour of the body, linear."""

STILL = 1e-6
"""What changes less than this (metres, or a quaternion's numbers) over a whole motion has no keys."""


@dataclass(frozen=True, eq=False)
class View:
    """A camera as glTF knows it, which looks along its own -Z.

    Attributes:
        place: metres, Y up.
        rotation: turns the camera's own axes (x right, y up, z backward) into the scene's.
        height: angle that it sees from the lowest to the highest row, radians.
        aspect: width of the picture over its height.
    """

    place: Float[np.ndarray, 3]
    rotation: Float[np.ndarray, "3 3"]
    height: float
    aspect: float


def write_glb(
    path: Path,
    motions: Float[np.ndarray, "t j 3"] | Sequence[Float[np.ndarray, "t j 3"]],
    skeleton: Skeleton,
    fps: float,
    surface: Surface | None = None,
    view: View | None = None,
) -> None:
    """Writes motions as animated bodies, whole or not at all.

    A body is one skinned mesh of capsules over a tree of nodes, of which those with the names of joints are at the
    joints in every key. There is a key for every frame, at its time; bones stretch as they do in the motion. Several
    bodies are people of their own, each in a colour of its own, that move side by side in one animation.

    Args:
        path: of the file, which ends in .glb.
        motions: one, or several; metres, Y up.
        skeleton: whose joints they are.
        fps: frames a second.
        surface: the place around the person.
        view: the camera.

    Raises:
        SagError: the motion is not finite or not of the skeleton, or the file cannot be written.
    """
    check_suffix(path, ".glb")
    people = [motions] if isinstance(motions, np.ndarray) else list(motions)
    for joints in people:
        check_motion(joints, skeleton, fps)
    document = GltfDocument(f"sag {__version__}")
    for number, joints in enumerate(people):
        _add_person(document, joints.astype(np.float64), skeleton, fps, number if len(people) > 1 else None)
    if surface is not None:
        document.show(add_surface(document, surface))
    if view is not None:
        document.show(_add_view(document, view))
    with writing_in(path, "name another place"):
        write_whole(path, lambda file: file.write(document.glb()))


def _add_person(document: GltfDocument, joints: np.ndarray, skeleton: Skeleton, fps: float, number: int | None) -> None:
    bare = rig_of(skeleton, median_lengths(joints, skeleton), split=True)
    rig = with_ends(bare)
    turns = rig.rotations(joints)
    steps, quaternions = rig.steps(joints, turns), _quaternions(turns)
    nodes = [
        document.add("nodes", {"name": name, "translation": numbers(step), "rotation": numbers(turn)})
        for name, step, turn in zip(rig.names, steps[0], quaternions[0])
    ]
    for place, node in enumerate(nodes):
        if children := rig.children(place):
            document.content["nodes"][node]["children"] = [nodes[0] + child for child in children]
    document.show(nodes[0])
    _animate(document, nodes[0], steps, quaternions, fps)
    document.show(_add_body(document, nodes[0], rig, body_of(bare, skeleton), number))


def _quaternions(turns: np.ndarray) -> np.ndarray:
    """Turns as quaternions (x, y, z, w), each near the one before it, so that keys are joined the short way."""
    found = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_quat().reshape(*turns.shape[:2], 4)
    same = np.sign((found[1:] * found[:-1]).sum(axis=-1))
    found[1:] *= np.cumprod(np.where(same == 0, 1, same), axis=0)[..., None]
    return found


def _animate(document: GltfDocument, first: int, steps: np.ndarray, quaternions: np.ndarray, fps: float) -> None:
    """Keys of every node of a person that moves or turns, in the one animation of the document."""
    times = document.accessor((np.arange(len(steps)) / fps).astype(np.float32), bounded=True)
    if "animations" not in document.content:
        document.add("animations", {"name": "motion", "channels": [], "samplers": []})
    animation = document.content["animations"][0]
    for path, values in (("translation", steps), ("rotation", quaternions)):
        for node in range(values.shape[1]):
            # The root has keys in any case, so that a motion that stands still lasts as long as it does.
            if node and np.ptp(values[:, node], axis=0).max() < STILL:
                continue
            sampler = {"input": times, "output": document.accessor(values[:, node].astype(np.float32))}
            animation["samplers"].append(sampler | {"interpolation": "LINEAR"})
            target = {"node": first + node, "path": path}
            animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})


def _add_body(document: GltfDocument, first: int, rig: Rig, body: Body, number: int | None) -> int:
    """The node of the skinned mesh; each vertex is carried by one node, of which the first is told."""
    suffix = "" if number is None else f"_{number + 1}"
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(rig.names), 1, 1))
    inverse[:, :3, 3] = -rest_places(rig)
    carriers = np.zeros((len(body.nodes), 4), np.uint8 if len(rig.names) <= 256 else np.uint16)
    carriers[:, 0] = body.nodes
    weights = np.zeros((len(body.nodes), 4), np.uint8)
    weights[:, 0] = 255
    attributes = {
        "POSITION": document.accessor(body.vertices.astype(np.float32), VERTICES, bounded=True),
        "NORMAL": document.accessor(body.normals.astype(np.float32), VERTICES),
        "JOINTS_0": document.accessor(carriers, VERTICES),
        "WEIGHTS_0": document.accessor(weights, VERTICES, normalized=True),
    }
    skin_colour = SKIN if number is None else _linear(SAMPLE_COLOURS[number % len(SAMPLE_COLOURS)])
    surface = {"baseColorFactor": skin_colour, "metallicFactor": 0.0, "roughnessFactor": 0.7}
    primitive = {
        "attributes": attributes,
        "indices": document.accessor(numbered(body.triangles), INDICES),
        "material": document.add("materials", {"name": f"body{suffix}", "pbrMetallicRoughness": surface}),
    }
    mesh = document.add("meshes", {"name": f"body{suffix}", "primitives": [primitive]})
    joints = list(range(first, first + len(rig.names)))
    skin: dict[str, Any] = {"name": f"person{suffix}", "joints": joints, "skeleton": first}
    skin["inverseBindMatrices"] = document.accessor(inverse)
    return document.add("nodes", {"name": f"body{suffix}", "mesh": mesh, "skin": document.add("skins", skin)})


def _linear(colour: str) -> list[float]:
    """A colour #rrggbb as glTF wants it: linear, and opaque."""
    return [(int(colour[place : place + 2], 16) / 255) ** 2.2 for place in (1, 3, 5)] + [1.0]


def _add_view(document: GltfDocument, view: View) -> int:
    lens = {"yfov": view.height, "aspectRatio": view.aspect, "znear": 0.05, "zfar": 100.0}
    camera = document.add("cameras", {"name": "camera", "type": "perspective", "perspective": lens})
    turn = Rotation.from_matrix(view.rotation).as_quat()
    return document.add(
        "nodes", {"name": "camera", "camera": camera, "translation": numbers(view.place), "rotation": numbers(turn)}
    )
