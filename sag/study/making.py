"""`sag study make`: motions of runs in the same scenes, blinded, as a study."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from sag import __version__
from sag.data.selection import chosen_windows
from sag.errors import SagError
from sag.files import writing_in
from sag.runs import CONFIG
from sag.skeleton import Skeleton
from sag.sources import Sources, read_sources
from sag.study.folder import TRUTH, Settings, Study, now
from sag.study.pages import scene_text, study_page
from sag.study.writing import check_new, new_study, write_study
from sag.text import plain
from sag.types import FRAMES
from sag.viewer import ShownWindow, shown_window

PAPER_ROWS = ("none", "md", "mdpc")
"""CSGN, CSGN+M and CSGN+M+G: what the paper's study compares with the recorded motion."""

USUAL_REPEATS = 4

SEEDS_APART = 1_000_003
"""More than a data set has windows."""


def make(asked: argparse.Namespace) -> int:
    """Makes the study and says what is in it; returns the exit status 0.

    Raises:
        SagError: a source cannot be read, is not trained or does not fit the others, or an option is out of range.
    """
    check_new(asked.out)
    note = _note(asked.note)
    sources = read_sources(_runs(asked.sources), asked.reference, asked.cache_dir, FRAMES)
    if TRUTH in sources.names:
        raise SagError(f"{TRUTH} is in every study by itself; leave it out")
    places = chosen_windows(sources.places, None, asked.windows, "in these sources")
    study = new_study(asked.out, _settings(asked, sources, places))
    windows = [
        # Every scene has noise of its own, or all motions of a method would be alike.
        shown_window(sources.data, batch, sources.motions(batch, 1, asked.seed * SEEDS_APART + place), judge=False)
        for place, batch in zip(places, sources.batches(places))
    ]
    with writing_in(asked.out, "give another folder by --out"):
        fill(study, windows, sources.data.skeleton, note)
    _say(study)
    return 0


def fill(study: Study, windows: Sequence[ShownWindow], skeleton: Skeleton, note: str = "") -> None:
    """Writes a study of these windows.

    Args:
        study: not yet written.
        windows: one for each scene, with a row of one motion for each method but the ground truth, which is its own.
        skeleton: of the motions.
        note: what raters read first.
    """
    scenes = [scene_text(study, place, window, len(skeleton.joints)) for place, window in enumerate(windows)]
    write_study(study, study_page(study, skeleton, note), scenes)


def _runs(sources: Sequence[Path]) -> list[Path]:
    """The sources, with the paper's rows in the place of a sweep."""
    found = []
    for source in sources:
        is_sweep = source.is_dir() and not (source / CONFIG).is_file() and any(source.glob(f"*/{CONFIG}"))
        rows = [source / row for row in PAPER_ROWS] if is_sweep else [source]
        if missing := [row for row in rows if is_sweep and not (row / CONFIG).is_file()]:
            raise SagError(
                f"{source} has no trained row {missing[0].name}, which the paper's study compares; train it, or name "
                "the folders of the runs to compare"
            )
        found += rows
    return found


def _settings(asked: argparse.Namespace, sources: Sources, places: Sequence[int]) -> Settings:
    methods = (*sources.names, TRUTH)
    rounds = len(methods) if asked.rounds is None else asked.rounds
    usual = min(USUAL_REPEATS, len(places) * rounds // 4)
    return Settings(
        title=asked.title,
        data=sources.data.name,
        fingerprint=sources.data.cache.fingerprint,
        fps=sources.data.fps,
        frames=FRAMES,
        methods=methods,
        windows=tuple(places),
        rounds=rounds,
        repeats=usual if asked.repeats is None else asked.repeats,
        sampling_seed=asked.seed,
        made=now(),
        version=__version__,
    )


def _note(path: Path | None) -> str:
    if path is None:
        return ""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise SagError(f"--note {path} cannot be read as text ({error})") from error


def _say(study: Study) -> None:
    made, design = study.settings, study.design
    print(f"{len(made.windows)} scenes of {made.data}, each with {', '.join(made.methods)}")
    print(f"{design.turns} motions for each rater, {design.repeats} of them twice seen: about {study.minutes} min")
    print(f"orders are balanced over every {_cycle(len(made.methods))} raters")
    folder = plain(str(study.folder))
    print(f"the study is in {folder}: sag study serve {folder}, or sag study files {folder} --raters N")


def _cycle(methods: int) -> int:
    """Rows of the square that says who sees which method when."""
    return methods if methods % 2 == 0 else 2 * methods
