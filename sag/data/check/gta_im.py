"""What `sag data check` says of GTA-IM."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import track

from sag.data.check.recordings import Findings, examine
from sag.data.check.report import Line, Report, Section, Verdict, by_recording, several, within
from sag.data.check.scale import scale_lines
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


def _presence(root: Path, everything: Sequence[Findings]) -> list[Line]:
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


def _files(everything: Sequence[Findings], root: Path) -> list[Line]:
    """What can be read, and what cannot."""
    looks, broken = sum(len(found.looks) for found in everything), [s for found in everything for s in found.broken]
    partly = by_recording((found.folder, found.incomplete) for found in everything)
    lines = [Line("decoded", f"the pictures of {looks:,} frames", "ok" if looks else "look")]
    if partly:
        count = sum(len(found.incomplete) for found in everything)
        lines.append(Line("incomplete", f"some pictures are missing in {several(count, 'frame')}", "look", partly))
    said = f"{len(broken)}, in {several(sum(bool(found.broken) for found in everything), 'recording')}"
    verdict: Verdict = "broken" if broken else "ok"
    return [*lines, Line("broken files", said if broken else "none", verdict, within(broken, root))]


def _motion(readable: Sequence[Findings], step: float) -> list[Line]:
    """Teleports by more than a step (metres), cuts and zooms, with their frames."""
    jumps, cuts, zooms = (sum(len(getattr(found, name)) for found in readable) for name in ("jumps", "cuts", "zooms"))
    where = [
        f"{found.folder.name}: {cut.frame} to {cut.frame + 1}, {cut.step:.1f} m and {cut.turn:.0f} degrees, "
        f"focal length {cut.focal[0]:.0f} to {cut.focal[1]:.0f} px"
        for found in readable
        for cut in found.cuts
    ]
    over = f"which no window goes over: by more than {step:g}"
    jumped, zoomed = (by_recording((f.folder, get(f)) for f in readable) for get in (_jumps, _zooms))
    return [
        Line("root teleports", f"{jumps}, {over} m; after the frames" if jumps else "0", details=jumped),
        Line("camera cuts", f"{cuts}, which drop no window; between the frames" if cuts else "0", details=tuple(where)),
        Line("camera zooms", f"{zooms}, which drop no window; in the frames" if zooms else "0", details=zoomed),
    ]


def _jumps(found: Findings) -> list[int]:
    return found.jumps


def _zooms(found: Findings) -> list[str]:
    return [f"{first} to {last}" for first, last in found.zooms]
