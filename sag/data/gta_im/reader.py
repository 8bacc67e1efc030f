"""GTA-IM as planning and conversion see it."""

from __future__ import annotations

from sag.data.gta_im.filters import events, usable_starts
from sag.data.gta_im.recording import Recording
from sag.data.gta_im.views import stored_window
from sag.data.recordings.reader import Reader

GTA_IM = Reader("gta_im", Recording.read, usable_starts, stored_window, events=events)
"""How its recordings are read."""
