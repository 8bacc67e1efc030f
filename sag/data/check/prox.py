"""What `sag data check` says of PROX."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.progress import track

from sag.data.check.bodies import bones_line, bones_of
from sag.data.check.findings import Findings, broken_line, decoded_line, jumps_line
from sag.data.check.prox_looks import Look, look_at, look_lines
from sag.data.check.report import Line, Report, Section, Verdict, several
from sag.data.check.windows import Inspection, windows_section
from sag.data.prox import ProxDataModule
from sag.data.prox.recording import Recording, stems
from sag.data.recordings.filters import root_jumps
from sag.errors import SagError
from sag.skeleton import PROX_16

WAY = PROX_16.index("head", "neck", "chest", "root", "right_hip", "right_knee", "right_ankle")
"""Joints from the head along the bones to an ankle."""

KINDS = {"Color": ".jpg", "Depth": ".png", "BodyIndex": ".png", "BodyIndexColor": ".png", "Skeleton": ".json"}
"""Folders of a recording, and how their files end."""


Found = Findings[Recording, Look]


def inspect(module: ProxDataModule, pictures: int | None) -> Inspection:
    """Looks at every recording.

    Args:
        module: knows the root and what its windows must keep to.
        pictures: how many frames' pictures are decoded of each recording; all where nothing is given.

    Raises:
        SagError: there is no recording, or what all of them need is missing.
    """
    folders, say = module.files.recordings, Console(stderr=True)
    everything = [_examined(module, f, pictures) for f in track(folders, "checking", transient=True, console=say)]
    readable = [found for found in everything if found.recording is not None]
    usable = [found.folder for found in readable]
    plan = module.plan(usable) if usable else None
    known = [(found.folder.name, found.bones) for found in readable if found.bones is not None]
    looks = [look for found in readable for look in found.looks]
    there = (
        *_presence(module, readable),
        *_kinds(folders),
        decoded_line(everything),
        broken_line(everything, module.root),
    )
    sections = [
        Section("What is there", there),
        windows_section(plan, module.stride, "recordings", len(everything) - len(readable)),
    ]
    if readable:
        jumps = jumps_line(readable, module.form.limits.root_step)
        sections.append(Section("Motion and scale", (jumps, bones_line(known), *look_lines(looks))))
    return Inspection(Report(f"PROX in {module.root}", tuple(sections)), plan, module)


def _examined(module: ProxDataModule, folder: Path, pictures: int | None) -> Found:
    found = Found(folder)
    try:
        recording = found.recording = module.files.read(folder)
    except SagError as error:
        found.broken.append(str(error))
        return found
    found.bones = bones_of(recording.joints, PROX_16.bone_index, WAY)
    found.jumps = root_jumps(recording.joints[:, module.form.root_place], module.form.limits)
    found.look_at(range(len(recording)), pictures, partial(look_at, recording))
    return found


def _presence(module: ProxDataModule, readable: Sequence[Found]) -> list[Line]:
    """What lies beside the recordings."""
    root, scenes = module.root, Counter(path.name.split("_")[0] for path in module.files.recordings)
    bodies = "PROXD's fits" if module.files.bodies else "the Kinect's skeletons: give smplx_models for PROXD's fits"
    frames = sum(len(found.recording or ()) for found in readable)
    lines = [
        Line("recordings", f"{sum(scenes.values())} of the 60 that are published"),
        Line("scenes", ", ".join(f"{name} ({several(count, 'recording')})" for name, count in sorted(scenes.items()))),
        Line("frames", f"{frames:,}", "ok" if frames else "broken"),
        Line("bodies", bodies, "ok" if module.files.bodies else "look"),
    ]
    for name, ending, needed in (("cam2world", ".json", True), ("scenes", ".ply", module.files.depth == "scan")):
        missing = sorted(scene for scene in scenes if not (root / name / f"{scene}{ending}").is_file())
        verdict: Verdict = "ok" if not missing else "broken" if needed else "look"
        said = f"missing for {several(len(missing), 'scene')}" if missing else "of every scene"
        lines.append(Line("scans" if name == "scenes" else name, said, verdict, tuple(missing)))
    return lines


def _kinds(folders: Sequence[Path]) -> list[Line]:
    """How many files of each kind there are, and the recordings that lack some of them."""
    lines = []
    for kind, ending in KINDS.items():
        counts = {folder: len(stems(folder / kind, ending)) for folder in folders}
        colours = {folder: len(stems(folder / "Color", ".jpg")) for folder in folders}
        fewer = tuple(f"{f.name}: {counts[f]:,} of {colours[f]:,}" for f in folders if counts[f] < colours[f])
        few = f"; fewer than colour in {several(len(fewer), 'recording')}" if fewer else ""
        said = f"{sum(counts.values()):,} files{few}"
        lines.append(Line(kind, said, "look" if fewer else "ok", fewer))
    return lines
