"""Numbers and pictures as text in a page: 16-bit steps and JPEG in base64."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from PIL import Image

from sag.files import finite

QUALITY = 86
"""Of the pictures, per cent."""

LARGEST_STEP = 32767
"""Of 16 bits."""


def packed(array: np.ndarray) -> str:
    """An array of whole numbers as base64 of its bytes, the lowest first."""
    return base64.b64encode(np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes()).decode()


def packed_places(places: np.ndarray) -> dict[str, Any]:
    """Places in metres as 16-bit steps of the size that the farthest needs; 20 m give steps of 0.6 mm."""
    step = max(float(np.abs(places).max()), 1e-3) / LARGEST_STEP
    return {"step": step, "shape": list(places.shape), "places": packed(np.round(places / step).astype(np.int16))}


def packed_picture(picture: np.ndarray) -> str:
    """Colours as a JPEG in base64."""
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=QUALITY, optimize=True)
    return base64.b64encode(file.getvalue()).decode()


def script_json(content: Mapping[str, Any]) -> str:
    """JSON that no name in it can lead out of a script element; what is no number becomes null."""
    text = json.dumps(finite(content), ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for sign in "<>&":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return text
