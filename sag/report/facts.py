"""What must be said with the figures: notices that a reader needs first, and the facts below a table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sag.report.lines import Line, twin_ratios
from sag.report.paper import PaperFigures
from sag.report.results import Result, few

FEW_MOTIONS = 500
"""Motions below which a Frechet distance says more about N than about the motions."""


def notices_of(lines: Sequence[Line], paper: PaperFigures) -> tuple[str, ...]:
    """Failed rows, NaN, too few motions, unequal seeds or commits, the data's own notes, and who was pre-trained."""
    result = _any(lines)
    notices = []
    motions = int(result.protocol.get("motions", 0))
    if motions < FEW_MOTIONS:
        notices.append(f"N = {motions} is far too small for these figures to mean anything.")
    notices += [f"{str(note).rstrip('.')}." for note in result.data.get("notes", [])]
    notices += _pretraining(lines, paper) + _unequal_seeds(lines) + _commits(lines)
    for line in lines:
        wrong = [name for name, figure in line.figures.items() if math.isnan(figure.mean)]
        if wrong:
            notices.append(f"NaN in {line.label}: {', '.join(wrong)}.")
        notices += [f"{r.label} {_has(r.state)}: {r.reason.rstrip('.')}." for r in line.unfinished]
    return tuple(notices)


def _pretraining(lines: Sequence[Line], paper: PaperFigures) -> list[str]:
    """Which rows started in checkpoints of other data, where some or the paper's did."""
    trained = [line for line in lines if line.finished and line.finished[0].steps]
    begun = [line.label for line in trained if any(result.pretrained for result in line.finished)]
    if begun and len(begun) < len(trained):
        return [f"Only {', '.join(begun)} started in checkpoints of other data; the other rows started anew."]
    if trained and not begun and paper.pretrained:
        return [f"No row was pre-trained; the paper's rows on {paper.source} were, on GTA-IM."]
    return []


def _unequal_seeds(lines: Sequence[Line]) -> list[str]:
    """Which rows have which seeds, where some that train have others."""
    rows: dict[tuple[int, ...], list[str]] = {}
    for line in lines:
        if line.kind != "truth" and line.finished:
            seeds = tuple(sorted(result.seed for result in line.finished if result.seed is not None))
            rows.setdefault(seeds, []).append(line.label)
    if len(rows) < 2:
        return []
    listed = "; ".join(f"{', '.join(map(str, seeds)) or 'none'} in {few(names)}" for seeds, names in rows.items())
    return [f"Rows have unequal seeds: {listed}. Comparisons by seed use those that both rows have."]


def _commits(lines: Sequence[Line]) -> list[str]:
    """Which rows come from which commit, where there are several."""
    rows: dict[str, list[str]] = {}
    for line in lines:
        for result in line.finished:
            rows.setdefault(str(result.origin.get("commit") or "unknown"), []).append(result.label)
    if len(rows) < 2:
        return []
    return [f"Rows come from different commits: {'; '.join(f'{c} in {few(names)}' for c, names in rows.items())}."]


def _has(state: str) -> str:
    return {"waiting": "has not run", "running": "is still running", "interrupted": "was interrupted"}.get(state, state)


def facts_of(lines: Sequence[Line], paper: PaperFigures) -> tuple[tuple[str, str], ...]:
    """Data, N, encoders, seeds, versions, and how to read the paper's columns."""
    result = _any(lines)
    facts = [("Data", _data(result)), ("N", _counts(result))]
    facts += [("Encoders of Motion FID", str(result.protocol.get("encoders")))]
    facts += [("Skeleton", str(result.protocol.get("skeleton"))), ("Seeds", _seeds(lines))]
    starts = sorted({r.pretrained for line in lines for r in line.finished if r.pretrained})
    facts += [("Pre-trained", f"training started in {', '.join(starts)}")] if starts else []
    facts += _ratios(lines)
    facts += [("Blind", WHAT_BLIND_IS)] if any(line.kind == "blind" for line in lines) else []
    facts.append(("Paper", f"printed figures on {paper.source}. {HOW_TO_READ}"))
    versions = {f"{name} {value}" for line in lines for r in line.finished for name, value in r.origin.items() if value}
    facts.append(("Versions", ", ".join(sorted(versions))))
    return tuple(facts)


def _ratios(lines: Sequence[Line]) -> list[tuple[str, str]]:
    """What M does to Motion FID in every pair of twins; a pair with NaN is said and left out of the smallest."""
    ratios = twin_ratios(lines)
    known = [ratio for ratio in ratios.values() if not math.isnan(ratio)]
    if not ratios:
        return []
    pairs = ", ".join(f"{pair} {'NaN' if math.isnan(ratio) else f'{ratio:.2f}'}" for pair, ratio in ratios.items())
    smallest = f"{min(known):.2f}" if known else "NaN"
    return [("Motion FID without M over its twin with M", f"{pairs}; smallest {smallest}")]


WHAT_BLIND_IS = (
    "the row m trained alike with its scene feature zeroed; what is no better than it shows no knowledge of the scene."
)

HOW_TO_READ = (
    "Motion FID depends on its encoders, which are trained on the data set: compare the order and the ratios "
    "of rows with the paper's, never the level."
)


FURTHER_COUNTS = {
    "groups": "floors and intervals from {}",
    "resamples": "{} resamples (interval)",
    "samples": "K = {} samples of each window (diversity, best of K)",
    "collision_shape": "bones as {}s (non-collision)",
    "floor": "the floor under feet is {}",
}
"""What else a protocol may say."""


def _any(lines: Sequence[Line]) -> Result:
    """Any finished run: all were measured alike."""
    return next(line.finished[0] for line in lines if line.finished)


def _data(result: Result) -> str:
    data = result.data
    windows = ", ".join(f"{count:,} {split}" for split, count in data.get("windows", {}).items())
    dropped = ", ".join(f"{count:,} {reason}" for reason, count in data.get("dropped", {}).items()) or "none"
    known = f"{data.get('name')} (fingerprint {data.get('fingerprint')}), {data.get('fps'):g} fps"
    return f"{known}, windows: {windows}; left out: {dropped}"


def _counts(result: Result) -> str:
    protocol = result.protocol
    frames, points = int(protocol.get("collision_frames", 0)), float(protocol.get("cloud_points", 0))
    counts = [
        f"{int(protocol.get('motions', 0)):,} motions (Motion FID)",
        f"{frames:,} frames (non-collision)",
        f"{points:,.0f} scene points a frame",
    ]
    counts += [text.format(protocol[key]) for key, text in FURTHER_COUNTS.items() if protocol.get(key)]
    return ", ".join(counts)


def _seeds(lines: Sequence[Line]) -> str:
    """The seeds of the rows, and what the figures are when there are several."""
    seeds = sorted({r.seed for line in lines for r in line.finished if line.components and r.seed is not None})
    counts = sorted({len(line.finished) for line in lines if line.components and line.finished})
    listed = ", ".join(map(str, seeds)) or "none"
    if not counts or counts[-1] == 1:
        return listed
    several = str(counts[0]) if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    return f"{listed}; figures are mean ± half of the 95 % t-interval over n = {several} runs of a row"
