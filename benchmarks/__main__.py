"""Measures every claim in one run, prints the table, and exits with status 1 when a claim is not met."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import torch
from rich.console import Console

from benchmarks import (
    cache_reads,
    clip_features,
    collisions,
    evaluation,
    frechet,
    sampling,
    training_loop,
    training_steps,
)
from benchmarks.claim import Claim, Say
from benchmarks.report import show, write

Benchmark = Callable[[bool, Say], Iterator[Claim]]
"""Measures its claims one by one, quickly or in earnest, and says what it is at."""

BENCHMARKS: dict[str, Benchmark] = {
    "frechet": frechet.claims,
    "features": clip_features.claims,
    "collisions": collisions.claims,
    "evaluation": evaluation.claims,
    "cache": cache_reads.claims,
    "step": training_steps.claims,
    "loop": training_loop.claims,
    "sampling": sampling.claims,
}


def main(arguments: Sequence[str] | None = None, benchmarks: Mapping[str, Benchmark] = BENCHMARKS) -> int:
    """Runs the benchmarks that are asked for; 1 when a claim is not met, else 0."""
    parser = argparse.ArgumentParser("python -m benchmarks", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=list(benchmarks), help="these benchmarks alone")
    parser.add_argument("--quick", action="store_true", help="tiny sizes and one round: shows that it runs, no more")
    parser.add_argument("--out", type=Path, default=Path("runs/bench/results.json"), help="file of the figures")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    progress = Console(stderr=True)
    found: list[Claim] = []
    for name in options.only or benchmarks:
        for claim in benchmarks[name](options.quick, lambda line: progress.print(f"... {line}", style="dim")):
            found.append(claim)
    show(found, Console(width=None if sys.stdout.isatty() else 160))
    write(found, options.out)
    missed = [claim.what for claim in found if not claim.met]
    progress.print(f"{len(found)} claims, {len(missed)} not met; figures in {options.out}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
