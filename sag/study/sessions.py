"""Sessions: what is put into the page for one rater. Nothing here needs networks, so that a server starts at once."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from sag.errors import SagError
from sag.study.folder import Study
from sag.study.store import Rater

MARKS = {"session": '"SESSION"', "scenes": '"SCENES"'}
"""What stands in the page where these belong."""


def session_of(study: Study, rater: Rater, answered: Sequence[int] = ()) -> dict[str, Any]:
    """What a rater's page is told: signed turns, and which of them are done.

    Args:
        study: that the rater takes part in.
        rater: who.
        answered: turns that are done.
    """
    turns = []
    for turn, item in enumerate(study.session(rater.number)):
        scene = study.scenes[study.items[item].scene]
        turns.append([study.signer.turn(rater.name, turn, item), scene, item])
    token = study.signer.session(rater.name)
    return {"rater": token, "place": rater.place, "turns": turns, "answered": list(answered)}


def page_for(study: Study, session: Mapping[str, Any] | None, scenes: str = "{}") -> str:
    """The page as a browser gets it.

    Args:
        study: that it is of.
        session: of the rater; None for who has none yet.
        scenes: those that the page carries with it, by name, as JSON.

    Raises:
        SagError: the page is missing or damaged.
    """
    path = study.public / "page.html"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise SagError(f"{path} cannot be read ({error}); make the study again") from error
    for name, content in (("session", json.dumps(session)), ("scenes", scenes)):
        before, mark, after = text.partition(MARKS[name])
        if not mark:
            raise SagError(f"{path} has no place for its {name}; make the study again")
        text = before + content + after
    return text


def all_scenes(study: Study) -> str:
    """Every scene by name as JSON, to stand in a page.

    Raises:
        SagError: one is missing.
    """
    return "{" + ",".join(f'"{name}":{scene_of(study, name)}' for name in study.scenes) + "}"


def scene_of(study: Study, name: str) -> str:
    """A scene as JSON.

    Raises:
        SagError: it is missing or damaged.
    """
    path = study.public / "scenes" / f"{name}.json"
    try:
        return path.read_text(encoding="ascii")
    except (OSError, ValueError) as error:
        raise SagError(f"{path} cannot be read ({error}); make the study again") from error
