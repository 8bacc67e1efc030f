"""Answers as they come from a page, by the network or in a file, checked before anything believes them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sag.errors import SagError
from sag.study.folder import Study
from sag.study.questions import QUESTIONS, SCALE, Scores

LONGEST = 7 * 24 * 3600.0
"""Seconds that an answer may take: who leaves the page open comes back within a week."""

MOST_PLAYS = 100_000


class Duplicate(SagError):
    """A second answer to the same question."""


@dataclass(frozen=True)
class Answer:
    """What a rater said of a motion.

    Attributes:
        rater: who.
        turn: place of the motion in the rater's session.
        item: the motion, by its name in pages.
        scores: 1 to 5, by question.
        seconds: from the first sight of the motion to the answer, as the page measured it.
        plays: times that the motion ran to its end.
    """

    rater: str
    turn: int
    item: str
    scores: Scores
    seconds: float
    plays: int


def checked_answer(study: Study, rater: str, number: int, content: object) -> Answer:
    """An answer that this rater may give.

    Args:
        study: that it must belong to.
        rater: whose session it comes with.
        number: of the rater.
        content: `turn`, `scores`, `seconds` and `plays`, as JSON gave them.

    Raises:
        Forged: the motion is none of the session's.
        SagError: something is missing, or a score is no whole number from 1 to 5.
    """
    if not isinstance(content, Mapping):
        raise SagError("an answer must be a JSON object with turn, scores, seconds and plays")
    items = study.session(number)
    turn = study.signer.turn_of(content.get("turn"), rater, items)
    return Answer(rater, turn, items[turn], _scores(content.get("scores")), *_effort(content))


def _scores(content: object) -> Scores:
    names = [question.name for question in QUESTIONS]
    if not isinstance(content, Mapping) or sorted(content) != sorted(names):
        raise SagError(f"scores must be {' and '.join(names)}, each from {SCALE[0]} to {SCALE[-1]}")
    for name in names:
        # A JSON true is no score, though Python takes it for 1.
        if type(content[name]) is not int or content[name] not in SCALE:
            raise SagError(f"the score {name} must be a whole number from {SCALE[0]} to {SCALE[-1]}")
    return {name: content[name] for name in names}


def _effort(content: Mapping[str, Any]) -> tuple[float, int]:
    seconds, plays = content.get("seconds"), content.get("plays")
    if type(seconds) not in (int, float) or not math.isfinite(seconds) or not 0 <= seconds <= LONGEST:  # type: ignore[arg-type, operator]
        raise SagError(f"seconds must be a number from 0 to {LONGEST:.0f}")
    if type(plays) is not int or not 0 <= plays <= MOST_PLAYS:
        raise SagError(f"plays must be a whole number from 0 to {MOST_PLAYS}")
    return float(seconds), plays  # type: ignore[arg-type]
