"""The report of `sag data check`: how it stands on a terminal, and the bones in it."""

from dataclasses import replace

import numpy as np
import pytest
from gta_im_files import body
from rich.console import Console

from sag.data.check.bodies import Bones, bones_line, bones_of
from sag.data.check.gta_im_recording import LIMBS, WAY
from sag.data.check.report import WIDTH, Line, Report, Section, graded, show
from sag.data.gta_im.recording import JOINTS
from sag.text import plain


def test_the_verdict_names_what_is_unusual():
    lines = (Line("a", "1", "ok"), Line("b", "2", "look"), Line("b", "3", "look"))
    assert Report("x", (Section("s", lines),)).verdict == "nothing is broken; worth a look: b"
    assert Report("x", (Section("s", (*lines, Line("c", "4", "broken"))),)).verdict == "BROKEN: c"
    assert [graded(v, 1, 2) for v in (1, 2, 2.1)] == ["ok", "look", "broken"]


def test_names_cannot_move_the_cursor_and_details_are_few():
    assert plain("a\x1b[2Jb\n会\udcff") == "a\\x1b[2Jb\\n会\\udcff"
    console = Console(width=80, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    show(Report("[red]x", (Section("s", (Line("[b]", "v", "", tuple(f"\x07{n}" for n in range(20))),)),)), console)
    said = console.export_text()
    assert "and 12 more" in said and "\x07" not in said and "[red]x" in said and "[b]" in said


@pytest.mark.parametrize("width", [80, 100, 120])
def test_a_report_keeps_to_the_terminal_and_to_what_can_be_read(width):
    console = Console(width=width, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    show(Report("x", (Section("s", (Line("a name", 60 * "word ", "look", (60 * "file ",)),)),)), console)
    lines = [line.rstrip() for line in console.export_text().splitlines()]
    assert min(width, WIDTH) - 6 < max(map(len, lines)) <= min(width, WIDTH)
    assert lines[3].startswith("look   a name")


def test_bones_are_measured():
    joints = np.tile(body(), (4, 1, 1))
    joints[2, JOINTS.index("left_wrist")] += [0, 0, 0.03]
    joints[3, 0] = np.nan
    bones = bones_of(joints, LIMBS, WAY)
    assert bones.stature == pytest.approx(0.15 + 0.2 + 4 * 0.1 + 0.1 + 0.4 + 0.4) and bones.plausible
    assert bones.stray == pytest.approx(0.03, abs=1e-9)
    assert bones_of(joints[3:], LIMBS, WAY) is None
    assert bones_line([("a", bones)]).verdict == "look"
    tiny = Bones(1e-4, 5e-4, 1.6e-3, 0.0)
    assert bones_line([("a", bones), ("b", tiny)]).details == ("b: 0.0016 m",)
    giant = replace(bones, stature=1700.0)
    assert bones_line([("a", bones), ("b", giant)]).details == (
        "b: 1700 m, as if joints were in millimetres: divide them by 1000",
    )
