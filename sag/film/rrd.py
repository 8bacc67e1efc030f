"""Motions as a recording for rerun's viewer: https://rerun.io, an extra."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from sag.errors import SagError
from sag.files import writing_in
from sag.film.overlay import as_bytes
from sag.film.stage import Stage
from sag.viewer.body import radius_of

TIMELINE = "time"


def write_rrd(path: Path, stage: Stage, name: str) -> None:
    """Writes the motions, the place around them, the camera and its picture, whole or not at all.

    Everything stands in the frame with Y up whose origin is on the floor under the start; metres.

    Args:
        path: ends in .rrd.
        stage: what is shown.
        name: of the recording.

    Raises:
        SagError: rerun is not installed, or the file cannot be written.
    """
    try:
        import rerun
    except ImportError as error:
        raise SagError(f"{path} needs rerun: pip install rerun-sdk (the extra `rerun`)") from error
    if path.suffix.lower() != ".rrd" or path.is_dir():
        raise SagError(f"{path} must be a file that ends in .rrd")
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    with writing_in(path, "name another place"):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with rerun.RecordingStream(f"sag_{name}") as recording:
                recording.save(partial)
                recording.log("/", rerun.ViewCoordinates.RIGHT_HAND_Y_UP, static=True)
                _log_place(rerun, recording, stage)
                _log_people(rerun, recording, stage)
                recording.flush()
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)


def _log_place(rerun: Any, recording: Any, stage: Stage) -> None:
    """Surface, camera and picture."""
    if stage.surface is not None:
        scene = stage.surface.stood_up(stage.upright)
        mesh = rerun.Mesh3D(
            vertex_positions=scene.points, triangle_indices=scene.triangles, vertex_texcoords=scene.places,
            albedo_texture=scene.picture,
        )  # fmt: skip
        recording.log("scene", mesh, static=True)
    if stage.picture is None or stage.intrinsics is None:
        return
    place = stage.upright.from_camera(np.zeros(3))
    recording.log("camera", rerun.Transform3D(translation=place, mat3x3=stage.upright.rotation), static=True)
    size = stage.picture.shape[1::-1]
    lens = rerun.Pinhole(image_from_camera=stage.intrinsics, resolution=size, camera_xyz=rerun.ViewCoordinates.RDF)
    recording.log("camera/picture", lens, static=True)
    recording.log("camera/picture", rerun.Image(stage.picture).compress(90), static=True)


def _log_people(rerun: Any, recording: Any, stage: Stage) -> None:
    """Joints and bones of every sample at every frame."""
    radii = [radius_of(joint) for joint in stage.skeleton.joints]
    bones = stage.skeleton.bone_index
    thick = [min(radii[start], radii[end]) for start, end in bones.tolist()]
    standing = stage.upright.from_camera(stage.motions)
    for frame in range(stage.frames):
        recording.set_time(TIMELINE, duration=frame / stage.fps)
        for number, motion in enumerate(standing):
            colour = as_bytes(stage.colour(number)[None, None])[0, 0]
            joints = rerun.Points3D(motion[frame], radii=radii, colors=colour, keypoint_ids=range(len(radii)))
            recording.log(f"sample_{number + 1}/joints", joints)
            limbs = rerun.LineStrips3D(motion[frame][bones], radii=thick, colors=colour)
            recording.log(f"sample_{number + 1}/bones", limbs)
