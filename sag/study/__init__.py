"""The user study of the paper's Table 5: made, served or handed out, and told.

Only making needs networks; the other commands start without them. See `docs/study.md`.
"""

from sag.study.command import main

__all__ = ["main"]
