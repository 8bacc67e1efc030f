"""What `sag data check` says of GTA-IM."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import track

from sag.data.check.findings import broken_line, decoded_line, jumps_line
from sag.data.check.gta_im_recording import GtaImFindings, examine
from sag.data.check.gta_im_scale import scale_lines
from sag.data.check.report import Line, Report, Section, by_recording, several
from sag.data.check.windows import Inspection, windows_section
from sag.data.gta_im.files import ARCHIVE
from sag.data.gta_im.module import RATES, GtaImDataModule
from sag.data.gta_im.recording import recordings_in


def inspect(module: GtaImDataModule, pictures: int | None) -> Inspection:
    """Looks at every recording.

    Args:
        module: knows the root and what its windows must keep to.
        pictures: how many frames' pictures are decoded of each recording; all where nothing is given.

    Raises:
        SagError: there is no recording.
    """
    used = module.folder()
    folders = [path for rate in RATES for path in recordings_in(module.root / rate)]
    say = Console(stderr=True)
    everything = [
        examine(path, module.form.limits, pictures)
        for path in track(folders, "checking recordings", transient=True, console=say)
    ]
    readable = [found for found in everything if found.recording is not None]
    mine = [found.folder for found in readable if found.folder.parent == used]
    plan = module.plan(mine) if mine else None
    broken = sum(found.recording is None and found.folder.parent == used for found in everything)
    sections = [
        Section("What is there", (*_presence(module.root, everything), *_files(everything, module.root))),
        windows_section(plan, module.stride, used.name, broken),
    ]
    if readable:
        sections.append(Section("Motion and cameras", tuple(_motion(readable, module.form.limits.root_step))))
        sections.append(Section("Scale and units", scale_lines(readable)))
    return Inspection(Report(f"GTA-IM in {module.root}", tuple(sections)), plan, module)


def _presence(root: Path, everything: Sequence[GtaImFindings]) -> list[Line]:
    rates = Counter(found.folder.parent.name for found in everything)
    absent = [rate for rate in RATES if rate not in rates]
    readable = [found.recording for found in everything if found.recording is not None]
    rooms = Counter(recording.room for recording in readable)
    frames, pictured = sum(map(len, readable)), sum(len(recording.pictured) for recording in readable)
    without = [found.folder.name for found in everything if not (found.folder / ARCHIVE).exists()]
    others = [path.name for rate in rates for path in sorted((root / rate).iterdir()) if path.is_dir()]
    strangers = sorted(set(others) - {found.folder.name for found in everything})
    numbers = ", ".join(f"{room} ({several(n, 'recording')})" for room, n in sorted(rooms.items()))
    lines = [
        Line("recordings", f"{len(everything)} ({', '.join(f'{n} in {rate}' for rate, n in rates.items())})"),
        Line("not there", ", ".join(absent).replace("FPS-30", "FPS-30, which the paper used") or "nothing"),
        Line("rooms", numbers or "not known"),
        Line("frames", f"{frames:,}", "ok" if frames else "broken"),
        Line("pictures", f"{pictured:,} frames with colour, depth and ids", "ok" if pictured else "broken"),
    ]
    if without:
        said = f"missing in {several(len(without), 'recording')}: joints and cameras come from the pickle there"
        lines.append(Line(ARCHIVE, said, "look", tuple(without)))
    if strangers:
        lines.append(Line("other folders", "these are no recordings", "look", tuple(strangers)))
    return lines


def _files(everything: Sequence[GtaImFindings], root: Path) -> list[Line]:
    """What can be read, and what cannot."""
    partly = by_recording((found.folder, found.incomplete) for found in everything)
    count = sum(len(found.incomplete) for found in everything)
    incomplete = Line("incomplete", f"some pictures are missing in {several(count, 'frame')}", "look", partly)
    return [decoded_line(everything), *([incomplete] if partly else []), broken_line(everything, root)]


def _motion(readable: Sequence[GtaImFindings], step: float) -> list[Line]:
    """Teleports by more than a step (metres), cuts and zooms, with their frames."""
    cuts, zooms = (sum(len(getattr(found, name)) for found in readable) for name in ("cuts", "zooms"))
    where = [
        f"{found.folder.name}: {cut.frame} to {cut.frame + 1}, {cut.step:.1f} m and {cut.turn:.0f} degrees, "
        f"focal length {cut.focal[0]:.0f} to {cut.focal[1]:.0f} px"
        for found in readable
        for cut in found.cuts
    ]
    zoomed = by_recording((f.folder, [f"{first} to {last}" for first, last in f.zooms]) for f in readable)
    return [
        jumps_line(readable, step),
        Line("camera cuts", f"{cuts}, which drop no window; between the frames" if cuts else "0", details=tuple(where)),
        Line("camera zooms", f"{zooms}, which drop no window; in the frames" if zooms else "0", details=zoomed),
    ]
