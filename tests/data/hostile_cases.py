"""Every damaged or hostile file, with the file that the refusal must name."""

from __future__ import annotations

import os
import zipfile

import hostile_files as bad
import hostile_traps as trap
import numpy as np
import pytest
from gta_im_files import COLUMNS, ROWS
from hostile_files import COLOUR, DEPTH, IDS, NPZ, PICKLE, ROOM, arrays, put
from PIL import Image

ARCHIVES = {
    "truncated": bad.truncated(NPZ),
    "empty": bad.replaced(NPZ, b""),
    "flipped_numbers": bad.flipped(NPZ, 0.3),
    "flipped_directory": bad.flipped_name,
    "text": bad.replaced(NPZ, b"<html>404 Not Found</html>"),
    "folder": bad.a_folder(NPZ),
    "pipe": bad.pipe(NPZ),
    "link_out": bad.linked(NPZ),
    "bomb": bad.member("intrinsics", bad.npy((900_000, 3, 3), bytes(900_000 * 72))),
    "claims_too_much": bad.member("intrinsics", bad.npy((10**12, 3, 3), bytes(720))),
    "claims_a_little_more": bad.member("intrinsics", bad.npy((71, 3, 3), bytes(70 * 72))),
    "understated_deflate": bad.understated(zipfile.ZIP_DEFLATED),
    "understated_bzip2": bad.understated(zipfile.ZIP_BZIP2),
    "understated_lzma": bad.understated(zipfile.ZIP_LZMA),
    "objects": arrays(joints_3d_world=lambda a: np.array([trap.Calls(os.mkdir, "canary")])),
    "text_numbers": arrays(intrinsics=lambda a: a.astype(str)),
    "lacks_an_array": arrays(world2cam_trans=lambda a: None),
    "holds_an_array_twice": bad.twice,
    "names_that_climb": bad.climbing,
    "other_joints": arrays(joints_3d_world=lambda a: a[:, :20]),
    "other_lengths": arrays(intrinsics=lambda a: a[:-1]),
    "no_frames": arrays(**{name: lambda a: a[:0] for name in ("joints_3d_world", "world2cam_trans", "intrinsics")}),
    "nan_joint": arrays(joints_3d_world=put((5, 3), np.nan)),
    "infinite_joint": arrays(joints_3d_world=put((5, 3), np.inf)),
    "joint_out_of_the_world": arrays(joints_3d_world=put((5, 3), 1e9)),
    "nan_focal_length": arrays(intrinsics=put((5, 0, 0), np.nan)),
    "zero_focal_length": arrays(intrinsics=put((5, 0, 0), 0)),
    "negative_focal_length": arrays(intrinsics=put((5, 1, 1), -100)),
    "giant_picture": arrays(intrinsics=put((slice(None), slice(2), 2), 30_000)),
    "changing_picture": arrays(intrinsics=put((5, 0, 2), 50)),
    "wrong_last_row": arrays(intrinsics=put((5, 2, 2), 0)),
    "singular_camera": arrays(world2cam_trans=put((5, slice(3), 0), 0)),
    "mirrored_camera": arrays(world2cam_trans=lambda a: a * [[-1, 1, 1, 1]]),
    "scaled_camera": arrays(world2cam_trans=lambda a: a * [[100], [100], [100], [1]]),
    "camera_for_columns": arrays(world2cam_trans=lambda a: a.swapaxes(1, 2)),
}

PICKLES = {
    "truncated": bad.truncated(PICKLE),
    "empty": bad.replaced(PICKLE, b""),
    "missing": bad.missing(PICKLE),
    "link_out": bad.linked(PICKLE),
    "no_list": trap.pickled(PICKLE, {"frames": []}),
    "no_frames_in_it": trap.pickled(PICKLE, [1, 2]),
    "frame_twice": trap.pickled(PICKLE, [{"time": "00003"}, {"time": "00004"}, {"time": "00003"}]),
    "near_clip_zero": trap.clips(cam_near_clip=0.0),
    "near_clip_negative": trap.clips(cam_near_clip=-1.0),
    "near_clip_nan": trap.clips(cam_near_clip=float("nan")),
    "near_clip_text": trap.clips(cam_near_clip="near"),
    "far_clip_infinite": trap.clips(cam_far_clip=float("inf")),
    "far_clip_before_near": trap.clips(cam_far_clip=0.05),
    "far_memo": bad.replaced(PICKLE, trap.FAR_MEMO),
    "long_bytes": bad.replaced(PICKLE, trap.LONG_BYTES),
    "copies": trap.pickled(PICKLE, lambda folder: trap.copies()),
    "endless_key": bad.replaced(PICKLE, trap.endless_key()),
    **{name: bad.replaced(PICKLE, content) for name, content in trap.swellings().items()},
    "deep_nest": bad.replaced(PICKLE, b"\x80\x02" + 100_000 * b"]" + 99_999 * b"a" + b"."),
    **{f"gadget_{name}": trap.pickled(PICKLE, gadget) for name, gadget in trap.gadgets().items()},
}

ROOMS = {
    "truncated": bad.truncated(ROOM),
    "missing": bad.missing(ROOM),
    "compressed": bad.compressed,
    "no_room": trap.pickled(ROOM, {"setting": {}}),
    "giant_room": trap.pickled(ROOM, {"setting": {"room": 10**300}}),
    "infinite_room": trap.pickled(ROOM, {"setting": {"room": float("inf")}}),
    "gadget": trap.pickled(ROOM, trap.gadgets()["system"]),
}

GREY = Image.new("L", (COLUMNS, ROWS), 7)

PICTURES = {
    (COLOUR, "truncated"): bad.truncated(COLOUR),
    (COLOUR, "without_its_last_bytes"): bad.truncated(COLOUR, 0.999),
    (COLOUR, "empty"): bad.replaced(COLOUR, b""),
    (COLOUR, "flipped_header"): bad.flipped(COLOUR, 0.0),
    (COLOUR, "text"): bad.replaced(COLOUR, b"<html>404 Not Found</html>"),
    (COLOUR, "gif"): trap.as_gif,
    (COLOUR, "link_out"): bad.linked(COLOUR),
    (COLOUR, "pipe"): bad.pipe(COLOUR),
    (COLOUR, "grey"): trap.picture(COLOUR, GREY),
    (COLOUR, "cut_off"): trap.cut_off,
    (COLOUR, "giant"): bad.replaced(COLOUR, trap.png_of(60_000, 60_000)),
    (COLOUR, "larger_than_the_camera"): trap.picture(
        COLOUR, Image.effect_noise((COLUMNS + 1, ROWS), 50).convert("RGB")
    ),
    (DEPTH, "truncated"): bad.truncated(DEPTH),
    (DEPTH, "flipped_pixels"): bad.flipped(DEPTH, 0.5),
    (DEPTH, "flipped_header"): bad.flipped(DEPTH, 0.0),
    (DEPTH, "giant"): bad.replaced(DEPTH, trap.png_of(60_000, 60_000)),
    (DEPTH, "large"): bad.replaced(DEPTH, trap.png_of(9_000, 9_000)),
    (DEPTH, "no_pixels"): bad.replaced(DEPTH, trap.png_of(COLUMNS, ROWS)),
    (DEPTH, "text_bomb"): trap.pickled(DEPTH, lambda folder: trap.text_bomb()),
    (DEPTH, "link_out"): bad.linked(DEPTH),
    (DEPTH, "palette"): trap.picture(DEPTH, GREY.convert("P")),
    (IDS, "truncated"): bad.truncated(IDS),
    (IDS, "flipped_pixels"): bad.flipped(IDS, 0.5),
    (IDS, "giant"): bad.replaced(IDS, trap.png_of(60_000, 60_000)),
}

RECORDINGS = {
    "link_out": (bad.linked_folder, "rec"),
    "depth_of_nothing": (trap.single(DEPTH), "rec"),
    "depth_of_the_sky": (trap.single(DEPTH, (255, 255, 255)), "rec"),
    "nobody": (trap.single(IDS), "rec"),
    "digits_of_another_script": (bad.arabic_digits, "rec"),
}

CASES = [
    *(pytest.param(damage, NPZ, id=f"npz_{name}") for name, damage in ARCHIVES.items()),
    *(pytest.param(damage, PICKLE, id=f"pickle_{name}") for name, damage in PICKLES.items()),
    *(pytest.param(damage, ROOM, id=f"room_{name}") for name, damage in ROOMS.items()),
    *(pytest.param(damage, file, id=f"{file}_{name}") for (file, name), damage in PICTURES.items()),
    *(pytest.param(damage, file, id=f"recording_{name}") for name, (damage, file) in RECORDINGS.items()),
]
