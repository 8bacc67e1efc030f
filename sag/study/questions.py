"""The two questions of the study (paper, section 4.3), and the scale they are answered on."""

from __future__ import annotations

from typing import Literal, NamedTuple

Name = Literal["scene", "human"]
"""What the columns of Table 5 are called."""

SCALE = (1, 2, 3, 4, 5)
"""Scores that may be given."""

LOWEST, HIGHEST = "strongly abnormal", "strongly compatible"
"""What the ends of the scale mean, in the paper's words."""


class Question(NamedTuple):
    """A question.

    Attributes:
        name: of its scores.
        title: what the paper calls it.
        asked: as a rater reads it.
        hint: what to look for.
    """

    name: Name
    title: str
    asked: str
    hint: str


QUESTIONS = (
    Question(
        "scene", "Scene compatibility", "Does the motion fit the scene?",
        "Walking through furniture or walls, floating, sinking into the floor or sitting on air does not fit.",
    ),
    Question(
        "human", "Motion compatibility", "Do the movements of the body fit its path?",
        "Sliding feet, gliding without steps, limbs that stretch and sudden jumps do not fit.",
    ),
)  # fmt: skip
"""Scene compatibility: between the motion and the scene. Motion compatibility: between trajectory and poses."""

Scores = dict[Name, int]
"""An answer to both, by the name of the question."""
