"""Every damaged or hostile file of PROX, with the part of its place that the refusal must name."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import hostile_files as bad
import hostile_scans as scan
import hostile_traps as trap
import numpy as np
import pytest
from hostile_files import Damage
from PIL import Image
from prox_files import COLUMNS, ROWS, frame_name

NAME = "MPH16_00157_01"
FRAME = frame_name(1, 0.029)
LENS, INFRARED, CAMERA, SCAN = "calibration/Color.json", "calibration/IR.json", "cam2world/MPH16.json", scan.SCAN
COLOUR, DEPTH, MASK, SKELETON = (
    f"recordings/{NAME}/{kind}/{FRAME}.{ending}"
    for kind, ending in (("Color", "jpg"), ("Depth", "png"), ("BodyIndexColor", "png"), ("Skeleton", "json"))
)
RESULTS = f"PROXD/{NAME}/results"
FIT = f"{RESULTS}/{FRAME}/000.pkl"

DEEP, LONG, HUGE = 100_000 * "[", "9" * 5000, 10**400
"""A nest without end, a number of more digits than are read, and one that no float holds."""


# --- JSON and pickles ---


def text(path: str, content: str) -> Damage:
    return lambda root: (root / path).write_text(content)


def told(path: str, change: Callable[[Any], Any]) -> Damage:
    """Other content of a JSON file."""
    return lambda root: (root / path).write_text(json.dumps(change(json.loads((root / path).read_text()))))


def lens(path: str = LENS, **changes: object) -> Damage:
    return told(path, lambda content: {**content, **changes})


def matrix(change: Callable[[np.ndarray], object]) -> Damage:
    """Another place of the camera."""
    return told(CAMERA, lambda content: np.asarray(change(np.array(content))).tolist())


def focal(length: object) -> Damage:
    return lens(camera_mtx=[[length, 0, COLUMNS / 2], [0, length, ROWS / 2], [0, 0, 1]])


def joints(change: Callable[[dict[str, Any]], Any]) -> Damage:
    """Other joints of the tracked body."""
    return told(
        SKELETON, lambda content: {"Bodies": [{"IsTracked": True, "Joints": change(content["Bodies"][1]["Joints"])}]}
    )


def head(place: object) -> Damage:
    return joints(lambda named: {**named, "Head": {"Position": place}})


def fit(**changes: object) -> Damage:
    """Other numbers of a fit; nothing takes one away."""

    def damage(root: Path) -> None:
        content = {**pickle.loads((root / FIT).read_bytes()), **changes}
        kept = {name: value for name, value in content.items() if value is not None}
        (root / FIT).write_bytes(pickle.dumps(kept, protocol=2))

    return damage


# --- names ---


def renamed(name: str) -> Damage:
    """The second picture under another name."""

    def damage(root: Path) -> None:
        folder = (root / COLOUR).parent
        sorted(folder.iterdir())[1].rename(folder / f"{name}.jpg")

    return damage


def recording_called(name: str) -> Damage:
    return lambda root: (root / "recordings" / NAME).rename(root / "recordings" / name)


JSON = {
    **{(path, "truncated"): bad.truncated(path) for path in (LENS, CAMERA, SKELETON)},
    **{(path, "deep"): text(path, DEEP) for path in (LENS, CAMERA, SKELETON)},
    **{(path, "link_out"): bad.linked(path) for path in (LENS, CAMERA, SKELETON)},
    (LENS, "empty"): text(LENS, ""),
    (LENS, "text"): text(LENS, "<html>404 Not Found</html>"),
    (LENS, "no_object"): text(LENS, "[]"),
    (LENS, "large"): text(LENS, " " * (1 << 21)),
    (LENS, "pipe"): bad.pipe(LENS),
    (LENS, "missing"): bad.missing(LENS),
    (LENS, "long_number"): text(LENS, f'{{"camera_mtx": {LONG}}}'),
    (LENS, "huge_focal_length"): focal(HUGE),
    (LENS, "nan_focal_length"): focal(float("nan")),
    (LENS, "zero_focal_length"): focal(0),
    (LENS, "negative_focal_length"): focal(-106),
    (LENS, "of_other_pictures"): lens(camera_mtx=[[900, 0, 951], [0, 900, 536], [0, 0, 1]]),
    (LENS, "text_for_numbers"): lens(k="none"),
    (LENS, "deep_numbers"): lens(k=json.loads("[" * 200 + "]" * 200)),
    (LENS, "too_many_numbers"): lens(k=[0.0] * 1000),
    (INFRARED, "missing"): bad.missing(INFRARED),
    (INFRARED, "stretched"): lens(INFRARED, view_mtx=[[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
    (INFRARED, "infinite"): lens(INFRARED, view_mtx=[[1, 0, 0, float("inf")], [0, 1, 0, 0], [0, 0, 1, 0]]),
    (CAMERA, "missing"): bad.missing(CAMERA),
    (CAMERA, "singular"): matrix(np.zeros_like),
    (CAMERA, "mirrored"): matrix(lambda m: m @ np.diag([-1, 1, 1, 1])),
    (CAMERA, "3_x_4"): matrix(lambda m: m[:3]),
    (CAMERA, "ragged"): text(CAMERA, "[[1], [1, 2]]"),
    (CAMERA, "nan"): matrix(lambda m: m * [[1, 1, 1, np.nan]]),
    (CAMERA, "for_row_vectors"): matrix(np.transpose),
    (CAMERA, "out_of_the_world"): matrix(lambda m: m + [[0, 0, 0, 1e9], *[[0] * 4] * 3]),
    (SKELETON, "no_bodies"): text(SKELETON, '{"Bodies": {}}'),
    (SKELETON, "numbers_for_bodies"): text(SKELETON, '{"Bodies": [1]}'),
    (SKELETON, "24_joints"): joints(lambda named: list(named.values())[:24]),
    (SKELETON, "lacks_a_joint"): joints(lambda named: {n: j for n, j in named.items() if n != "Head"}),
    (SKELETON, "no_place"): head(None),
    (SKELETON, "nan_place"): head([0, float("nan"), 1]),
    (SKELETON, "huge_place"): head([0, HUGE, 1]),
    (SKELETON, "out_of_the_world"): head([0, 1e9, 1]),
}

FITS = {
    "truncated": bad.truncated(FIT),
    "empty": bad.replaced(FIT, b""),
    "link_out": bad.linked(FIT),
    "no_names": trap.pickled(FIT, [1, 2]),
    "lacks_betas": fit(betas=None),
    "20_joints": fit(body_pose=np.zeros((1, 60))),
    "no_row": fit(transl=np.zeros(3)),
    "nan": fit(transl=np.full((1, 3), np.nan)),
    "infinite": fit(global_orient=np.full((1, 3), np.inf)),
    "out_of_the_world": fit(transl=np.full((1, 3), 1e9)),
    "text": fit(betas="betas"),
    "objects": fit(betas=np.array([[None] * 10])),
    "far_memo": bad.replaced(FIT, trap.FAR_MEMO),
    "long_bytes": bad.replaced(FIT, trap.LONG_BYTES),
    "copies": trap.pickled(FIT, lambda root: trap.copies()),
    "endless_key": bad.replaced(FIT, trap.endless_key()),
    **{name: bad.replaced(FIT, content) for name, content in trap.swellings().items()},
    **{f"gadget_{name}": trap.pickled(FIT, gadget) for name, gadget in trap.gadgets().items()},
}

OTHER_SIZE = Image.effect_noise((COLUMNS + 1, ROWS), 50)

PICTURES = {
    **{
        (path, name): damage(path)
        for path in (COLOUR, MASK, DEPTH)
        for name, damage in {
            "truncated": bad.truncated,
            "flipped_header": lambda path: bad.flipped(path, 0.0),
            "giant": lambda path: bad.replaced(path, trap.png_of(60_000, 60_000)),
            "text_bomb": lambda path: trap.pickled(path, lambda root: trap.text_bomb()),
            "link_out": bad.linked,
        }.items()
    },
    (COLOUR, "grey"): trap.picture(COLOUR, OTHER_SIZE.crop((0, 0, COLUMNS, ROWS))),
    (COLOUR, "one_colour_at_its_end"): trap.single(COLOUR),
    (MASK, "flipped_pixels"): bad.flipped(MASK, 0.5),
    (MASK, "of_another_size"): trap.picture(MASK, OTHER_SIZE),
    (DEPTH, "flipped_pixels"): bad.flipped(DEPTH, 0.5),
    (DEPTH, "of_another_size"): trap.picture(DEPTH, OTHER_SIZE),
}

RECORDINGS = {
    "link_out": (bad.linked(f"recordings/{NAME}"), NAME),
    "pictures_link_out": (bad.linked(f"recordings/{NAME}/Color"), f"{NAME}/Color"),
    "cameras_link_out": (bad.linked("cam2world"), "cam2world"),
    "fits_link_out": (bad.linked(RESULTS), RESULTS),
    "fit_links_out": (bad.linked(f"{RESULTS}/{FRAME}"), f"{RESULTS}/{FRAME}"),
    "name_of_two_parts": (recording_called("MPH16_00157"), "MPH16_00157"),
    "frame_twice": (renamed(frame_name(1, 0.5)), NAME),
    "clock_runs_backwards": (renamed(frame_name(2, 9.0)), NAME),
    "name_of_no_frame": (renamed("holiday"), "holiday"),
    "digits_of_another_script": (renamed(FRAME.replace("0", "٠").replace("1", "٢")), NAME),
    "no_picture": (lambda root: [path.unlink() for path in (root / COLOUR).parent.iterdir()], f"{NAME}/Color"),
}

CASES = [
    *(pytest.param(damage, path, {}, id=f"{Path(path).parent.name}_{name}") for (path, name), damage in JSON.items()),
    *(pytest.param(damage, SCAN, {}, id=f"scan_{name}") for name, damage in scan.SCANS.items()),
    *(pytest.param(damage, FIT, {"fits": True}, id=f"fit_{name}") for name, damage in FITS.items()),
    *(
        pytest.param(damage, path, {"depth": "sensor"} if path == DEPTH else {}, id=f"{Path(path).parent.name}_{name}")
        for (path, name), damage in PICTURES.items()
    ),
    *(
        pytest.param(damage, path, {"fits": path.startswith("PROXD")}, id=f"recording_{name}")
        for name, (damage, path) in RECORDINGS.items()
    ),
]
