"""What the doctor finds where nothing is broken."""

from __future__ import annotations

from typing import Any

from sag.doctor.probed import Probed

CPU = {"name": "cpu", "about": "2 threads", "error": None}


def working(**more: Any) -> Probed:
    """What is found where nothing is broken."""
    devices = {"devices": [CPU], "built_for_cuda": None, "backends": ["gloo"]}
    return Probed({"torch": "2.13.0", "sag.training": "", "devices": devices, **more}, {})
