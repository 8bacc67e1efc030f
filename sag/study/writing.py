"""A study written to its folder, the private file last."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from sag.errors import SagError
from sag.files import write_json, write_whole
from sag.study.folder import FORMAT, Settings, Study


def check_new(folder: Path) -> None:
    """Refuses to write over a study.

    Raises:
        SagError: the folder holds one.
    """
    if (folder / "private" / "study.json").exists():
        raise SagError(f"{folder} holds a study already, maybe with answers; name another folder by --out")


def new_study(folder: Path, settings: Settings, key: bytes | None = None) -> Study:
    """A study to be filled, and written by `write_study`.

    Args:
        folder: where it is to lie.
        settings: what it is made of.
        key: that signs; a new one by default.

    Raises:
        SagError: there is a study already, or the settings cannot be shown.
    """
    check_new(folder)
    study = Study(folder, settings, key or secrets.token_bytes(32))
    study.design  # noqa: B018 - refuses what cannot be shown
    return study


def write_study(study: Study, page: str, scenes: Sequence[str]) -> None:
    """Writes what raters are shown, and last the private file without which there is no study.

    Args:
        study: that these belong to.
        page: the page without a session, as HTML.
        scenes: each with its motions, as JSON that may stand in a page.
    """
    write_text(study.public / "page.html", page)
    for name, text in zip(study.scenes, scenes):
        write_text(study.public / "scenes" / f"{name}.json", text)
    private = study.folder / "private"
    private.mkdir(parents=True, exist_ok=True)
    private.chmod(0o700)
    with _only_ours():
        write_json(private / "study.json", {"format": FORMAT, "key": study.key.hex(), **asdict(study.settings)})


def write_text(path: Path, text: str) -> None:
    """Writes a text whole or not at all."""
    write_whole(path, lambda file: file.write(text.encode()))


@contextmanager
def _only_ours() -> Iterator[None]:
    """What is written inside can be read by nobody else."""
    mask = os.umask(0o077)
    try:
        yield
    finally:
        os.umask(mask)
