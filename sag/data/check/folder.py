"""What `sag data check` says of a data set of one's own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from sag.data.check.bodies import bones_line, bones_of, way_between
from sag.data.check.findings import Findings, broken_line, decoded_line, jumps_line
from sag.data.check.report import Line, Report, Section, by_recording
from sag.data.check.sights import Sight, sight_lines
from sag.data.check.windows import Inspection, windows_section
from sag.data.folder import FolderDataModule
from sag.data.folder.files import MOTION
from sag.data.folder.recording import Recording
from sag.data.recordings.filters import inside_picture, pixels_of, root_jumps
from sag.errors import SagError
from sag.skeleton import Skeleton

Found = Findings[Recording, Sight]


def inspect(module: FolderDataModule, pictures: int | None) -> Inspection:
    """Looks at every recording.

    Args:
        module: knows the root and what its windows must keep to.
        pictures: how many frames' pictures are decoded of each recording; all where nothing is given.

    Raises:
        SagError: there is no recording.
    """
    folders, say = module.recordings(), Console(stderr=True)
    everything = [_examined(module, f, pictures) for f in track(folders, "checking", transient=True, console=say)]
    readable = [found.recording for found in everything if found.recording is not None]
    plan = module.plan([recording.folder for recording in readable]) if readable else None
    sights = [sight for found in everything for sight in found.looks]
    files = decoded_line(everything), broken_line(everything, module.root)
    there = (*_presence(module, readable), *_pictures(readable), *files)
    jumps = jumps_line(everything, module.form.limits.root_step)
    sections = (
        Section("What is there", there),
        windows_section(plan, module.stride, module.root.name, len(everything) - len(readable)),
        Section("Motion and scale", (jumps, _bones(module.told, everything), *sight_lines(sights))),
    )
    return Inspection(Report(f"Own data in {module.root}", sections), plan, module)


def _examined(module: FolderDataModule, folder: Path, pictures: int | None) -> Found:
    found = Found(folder)
    try:
        recording = found.recording = module.reader.read(folder)
    except SagError as error:
        found.broken.append(str(error))
        return found
    found.jumps = root_jumps(recording.joints[:, module.form.root_place], module.form.limits)
    if "head" in module.told.joints:
        way = way_between(module.told, "head", "right_ankle")
        found.bones = bones_of(recording.joints, module.told.bone_index, way)
    found.look_at(sorted(recording.pictures.complete), pictures, partial(_sight_of, recording, module.form.root_place))
    return found


def _sight_of(recording: Recording, root: int, frame: int) -> Sight:
    """Looks at a frame that has pictures; the root is the joint of this place.

    Raises:
        SagError: a picture cannot be read.
    """
    pictures, world = recording.pictures, recording.joints[frame]
    pictures.colour(frame)  # for what is broken in it alone
    depth, person = pictures.depth(frame), pictures.person(frame)
    joints = recording.seen_from(frame, slice(frame, frame + 1))[0]
    pixels = pixels_of(joints, recording.intrinsics[frame])
    inside = inside_picture(pixels, *recording.size) & (joints[:, 2] > 0)
    columns, rows = pixels[inside].astype(int).T
    seen = depth[rows, columns]
    gaps = (joints[inside, 2] - seen)[seen > 0]
    on_person = np.nan if person is None or not len(rows) else float(person[rows, columns].mean())
    height = float(world[root, 2] - world[recording.skeleton.feet, 2].min())
    return Sight(float(inside.mean()), gaps, on_person, height)


def _presence(module: FolderDataModule, readable: Sequence[Recording]) -> list[Line]:
    rooms = Counter(recording.room for recording in readable)
    frames, used = sum(map(len, readable)), {path.name for path in module.recordings()}
    others = tuple(sorted({path.name for path in module.root.iterdir() if path.is_dir()} - used))
    strangers = [Line("other folders", f"{len(others)} without a {MOTION}", "look", others)]
    return [
        Line("recordings", f"{len(used)} with a {MOTION}"),
        Line("skeleton", f"{module.told.name}: {len(module.told.joints)} joints, {module.told.root} is the root"),
        Line("rooms", ", ".join(f"{room}: {n}" for room, n in sorted(rooms.items())) + " (name: recordings)"),
        Line("frames", f"{frames:,}, {module.native_fps():g} a second", "ok" if frames else "broken"),
        *(strangers if others else []),
    ]


def _pictures(readable: Sequence[Recording]) -> list[Line]:
    """How many frames have pictures of which kind."""
    complete = sum(len(recording.pictures.complete) for recording in readable)
    partly = by_recording((r.folder, sorted(set(r.pictures.coloured) - r.pictures.complete)) for r in readable)
    told = sum(recording.pictures.tells_person(f) for recording in readable for f in recording.pictures.complete)
    said = f"told in {told:,} frames" + ("" if told == complete else "; in the others sought by the bones")
    lines = [
        Line("pictures", f"{complete:,} frames with colour and depth", "ok" if complete else "broken"),
        Line("person", said, "ok" if told == complete else "look"),
    ]
    return lines + ([Line("incomplete", "frames that lack their depth", "look", partly)] if partly else [])


def _bones(told: Skeleton, everything: Sequence[Found]) -> Line:
    if "head" not in told.joints:
        return Line("bones", "no joint is called head, so nobody's height is known", "look")
    return bones_line([(found.folder.name, found.bones) for found in everything if found.bones is not None])
