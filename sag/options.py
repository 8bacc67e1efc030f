"""Options that commands share, so that one name means one thing everywhere. Light: nothing heavy is imported here."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_cache_dir(parser: argparse._ActionsContainer) -> None:
    """Adds `--cache-dir`."""
    parser.add_argument("--cache-dir", type=Path, metavar="DIR", help="folder of the window caches, if it was moved")
