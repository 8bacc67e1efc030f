"""The study's page: the viewer's drawing under two questions, without a word of what is shown."""

from __future__ import annotations

from html import escape

from sag.skeleton import Skeleton
from sag.study.folder import Study
from sag.study.questions import HIGHEST, LOWEST, QUESTIONS, SCALE
from sag.viewer.assembly import assembled, asset, script_of
from sag.viewer.packing import script_json
from sag.viewer.page import cells_of, content_of, window_content
from sag.viewer.shown import ShownMotion, ShownRow, ShownWindow, check_windows

SCRIPTS = ("clip", "scales", "keeping", "study")
"""Modules of the page's script after those that draw, in the order in which they are joined."""


def study_page(study: Study, skeleton: Skeleton, note: str = "") -> str:
    """The page without a session and without scenes.

    Args:
        study: that it is of.
        skeleton: of the motions.
        note: what its owner wants raters to read first, as plain text; empty lines part paragraphs.
    """
    made = study.settings
    about = {
        "name": study.name,
        "turns": study.design.turns,
        "minutes": study.minutes,
        "scale": list(SCALE),
        "ends": [LOWEST, HIGHEST],
        "questions": [{"name": one.name, "asked": one.asked, "hint": one.hint} for one in QUESTIONS],
    }
    content = {**content_of(skeleton, made.fps), "windows": {}, "study": about}
    style = "\n".join((asset("style.css"), asset("style.css", "sag.study")))
    script = script_of(SCRIPTS, "sag.study")
    template = asset("page.html", "sag.study")
    texts = {"data": script_json(content), "note": _paragraphs(note)}
    return assembled(template, style, script, made.title, connect="'self'", **texts)


def _paragraphs(text: str) -> str:
    return "".join(f"<p>{escape(part.strip())}</p>" for part in text.split("\n\n") if part.strip())


def scene_text(study: Study, place: int, window: ShownWindow, joints: int) -> str:
    """A scene with its motions as JSON: no names, no figures, motions in the order of names that tell nothing.

    Args:
        study: that it is of.
        place: of the scene.
        window: with a row of one motion for each method, the ground truth as the recorded one.
        joints: that motions have.

    Raises:
        SagError: a motion cannot be shown.
    """
    check_windows([window], joints)
    motions = {row.name: row.motions[0] for row in window.rows}
    names = {item: study.settings.methods[which.method] for item, which in study.items.items() if which.scene == place}
    shown = [motions.get(name, window.truth) for _, name in sorted(names.items())]
    blind = ShownWindow(
        name="",
        picture=window.picture,
        intrinsics=window.intrinsics,
        person=window.person,
        rows=(ShownRow("", tuple(ShownMotion(motion.joints) for motion in shown if motion)),),
        scene=window.scene,
        up=window.up,
        floor=window.floor,
    )
    content = window_content(blind, cells_of(len(study.settings.windows)))
    return script_json({**content, "motions": sorted(names)})
