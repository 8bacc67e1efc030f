"""Answers with what they are about: the method behind a motion, and whether it was seen before."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from sag.errors import SagError
from sag.study.answers import Answer
from sag.study.folder import Study
from sag.study.store import Rater


@dataclass(frozen=True)
class Rating:
    """An answer, no longer blind.

    Attributes:
        answer: what was said.
        scene: place of the scene.
        method: whose motion it was.
        again: whether the rater had seen this motion before.
    """

    answer: Answer
    scene: int
    method: str
    again: bool

    @property
    def motion(self) -> tuple[int, str]:
        """What was scored."""
        return self.scene, self.method

    @property
    def rater(self) -> str:
        """Who scored it."""
        return self.answer.rater


def ratings_of(study: Study, raters: dict[str, Rater], answers: Iterable[Answer]) -> list[Rating]:
    """The answers of a study with the methods behind them.

    Args:
        study: that they belong to.
        raters: all that are enrolled.
        answers: of any of them.

    Raises:
        SagError: an answer is not about what its rater was shown, so that file and study do not belong together.
    """
    session = lru_cache(maxsize=None)(study.session)
    found = []
    for answer in answers:
        items = session(raters[answer.rater].number)
        if answer.turn >= len(items) or items[answer.turn] != answer.item:
            raise SagError(
                f"{study.answers}: rater {answer.rater} was not shown what answer {answer.turn + 1} is about; the file "
                "is of another study"
            )
        item = study.items[answer.item]
        again = answer.item in items[: answer.turn]
        found.append(Rating(answer, item.scene, study.settings.methods[item.method], again))
    return found


def first_ones(ratings: Sequence[Rating]) -> list[Rating]:
    """Without those of motions that were seen before: each rater speaks once of a motion."""
    return [rating for rating in ratings if not rating.again]
