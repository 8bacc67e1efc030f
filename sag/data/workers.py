"""Work that several processes share."""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import TypeVar

from rich.progress import track

T = TypeVar("T")


def shared_out(work: Callable[[int], T], count: int, workers: int, title: str) -> Iterator[T]:
    """What `work` makes of 0, 1, ... in order, under a progress bar; processes make it ahead.

    Args:
        work: can be pickled, and depends on nothing but its number.
        count: of numbers.
        workers: processes; with one the work is done in this process.
        title: of the progress bar.
    """
    say = partial(track, description=title, total=count)
    if workers <= 1:
        yield from say(map(work, range(count)))
        return
    # A forked worker starts at once; spawning would import torch again in each.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        yield from say(pool.map(work, range(count)))
