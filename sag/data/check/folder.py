"""What `sag data check` says of a data set of one's own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from sag.data.check.bodies import Bones, bones_line, bones_of
from sag.data.check.report import Line, Report, Section, by_recording
from sag.data.check.sights import Sight, sight_lines, sight_of, way_between
from sag.data.check.windows import Inspection, windows_section
from sag.data.folder import FolderDataModule
from sag.data.folder.files import MOTION
from sag.data.folder.recording import Recording
from sag.data.recordings.filters import root_jumps
from sag.errors import SagError
from sag.skeleton import Skeleton


@dataclass
class Findings:
    """One recording.

    Attributes:
        folder: its place.
        recording: what was read; nothing where it is broken.
        broken: sentences on files that are.
        sights: what its decoded frames show.
        bones: their lengths; nothing where no joint is called head.
        jumps: frames after which the root is elsewhere.
    """

    folder: Path
    recording: Recording | None = None
    broken: list[str] = field(default_factory=list)
    sights: list[Sight] = field(default_factory=list)
    bones: Bones | None = None
    jumps: list[int] = field(default_factory=list)


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
    sights = [sight for found in everything for sight in found.sights]
    sections = (
        Section("What is there", (*_presence(module, readable), *_pictures(readable), *_files(everything))),
        windows_section(plan, module.stride, module.root.name, len(everything) - len(readable)),
        Section("Motion and scale", (_motion(everything), _bones(module.told, everything), *sight_lines(sights))),
    )
    return Inspection(Report(f"Own data in {module.root}", sections), plan, module)


def _examined(module: FolderDataModule, folder: Path, pictures: int | None) -> Findings:
    found = Findings(folder)
    try:
        recording = found.recording = module.reader.read(folder)
    except SagError as error:
        found.broken.append(str(error))
        return found
    found.jumps = root_jumps(recording.joints[:, recording.root], module.form.limits)
    if "head" in module.told.joints:
        way = way_between(module.told, "head", "right_ankle")
        found.bones = bones_of(recording.joints, module.told.bone_index, way)
    frames = np.array(sorted(recording.pictures.complete))
    count = len(frames) if pictures is None else min(pictures, len(frames))
    for frame in frames[np.linspace(0, len(frames) - 1, count).round().astype(int)].tolist():
        try:
            found.sights.append(sight_of(recording, frame))
        except SagError as error:
            found.broken.append(str(error))
    return found


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


def _files(everything: Sequence[Findings]) -> list[Line]:
    decoded, broken = sum(len(found.sights) for found in everything), [s for found in everything for s in found.broken]
    said = f"{len(broken)}, in {sum(bool(found.broken) for found in everything)} recordings" if broken else "none"
    return [
        Line("decoded", f"the pictures of {decoded:,} frames", "ok" if decoded else "look"),
        Line("broken files", said, "broken" if broken else "ok", tuple(broken)),
    ]


def _motion(everything: Sequence[Findings]) -> Line:
    jumps = sum(len(found.jumps) for found in everything)
    where = by_recording((found.folder, found.jumps) for found in everything)
    return Line("root teleports", f"{jumps}, after the frames" if jumps else "0", details=where)


def _bones(told: Skeleton, everything: Sequence[Findings]) -> Line:
    if "head" not in told.joints:
        return Line("bones", "no joint is called head, so nobody's height is known", "look")
    return bones_line([(found.folder.name, found.bones) for found in everything if found.bones is not None])
