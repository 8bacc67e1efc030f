"""Without a server: a file for each rater, and the answers that come back from it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from sag.errors import SagError
from sag.study.answers import Answer, checked_answer
from sag.study.folder import Study
from sag.study.sessions import all_scenes, page_for, session_of
from sag.study.store import Rater, Store
from sag.study.tokens import Forged
from sag.study.writing import write_text

LARGEST = 10_000_000
"""Bytes of a file of answers: far more than any has."""


def write_handouts(study: Study, store: Store, count: int, folder: Path) -> list[Path]:
    """So many raters more, each with a page that carries everything.

    Args:
        study: that they take part in.
        store: where they are enrolled.
        count: of raters.
        folder: gets the files.
    """
    scenes, paths = all_scenes(study), []
    for _ in range(count):
        rater = store.enrol("file")
        paths.append(folder / f"study-{rater.name}.html")
        write_text(paths[-1], page_for(study, session_of(study, rater), scenes))
    return paths


def read_returned(study: Study, raters: dict[str, Rater], paths: Iterable[Path]) -> list[Answer]:
    """Answers of files that came back, each once though a file may come twice or again with more in it.

    Args:
        study: that they must belong to.
        raters: all that are enrolled.
        paths: of the files.

    Raises:
        SagError: a file is no file of answers, is not signed by this study, or contradicts another; it is named.
    """
    found: dict[tuple[str, int], Answer] = {}
    for path in paths:
        for answer in _read(study, raters, path):
            known = found.setdefault((answer.rater, answer.turn), answer)
            if known != answer:
                raise SagError(
                    f"{path} answers motion {answer.turn + 1} of rater {answer.rater} otherwise than a file before it; "
                    "ask the rater which one holds, and leave the other out"
                )
    return sorted(found.values(), key=lambda answer: (raters[answer.rater].number, answer.turn))


def _read(study: Study, raters: dict[str, Rater], path: Path) -> list[Answer]:
    content = _content(path)
    if content.get("study") != study.name:
        raise SagError(f"{path} is of another study; leave it out, or report on that one")
    try:
        rater = raters.get(study.signer.rater_of(content.get("rater")))
        if rater is None or rater.place != "file":
            raise Forged("its rater was given no file")
        answers = [checked_answer(study, rater.name, rater.number, one) for one in content["answers"]]
    except Forged as error:
        raise SagError(f"{path} is not signed by this study ({error}); leave it out") from error
    except SagError as error:
        raise SagError(f"{path} holds an answer that cannot be one ({error}); leave it out") from error
    _check_once(path, answers)
    return answers


def _content(path: Path) -> dict:
    """What a file of answers holds."""
    try:
        if path.stat().st_size > LARGEST:
            raise ValueError("it is too large")
        content = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(content, dict) or not isinstance(content.get("answers"), list):
            raise ValueError("it has no list of answers")
    except (OSError, ValueError, RecursionError) as error:
        raise SagError(f"{path} is no file of answers ({error}); ask the rater to download it again") from error
    return content


def _check_once(path: Path, answers: Sequence[Answer]) -> None:
    turns = [answer.turn for answer in answers]
    if twice := [turn for turn in turns if turns.count(turn) > 1]:
        raise SagError(f"{path} answers motion {twice[0] + 1} twice; leave it out, or ask the rater for another")
