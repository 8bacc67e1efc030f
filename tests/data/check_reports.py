"""What `sag data check` printed."""

from __future__ import annotations

import pytest

OPTIONS = ["--image_size=[54,96]", "--stride", "1"]
"""Of a check: small pictures, and every window."""


def told(capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """What a report says, by the name of the line: value and details in one."""
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    said: dict[str, str] = {}
    name = ""
    for line in lines:
        if line[:6].strip() in ("", "ok", "look", "broken") and len(line) > 7:
            name = line[7:22].strip() or name
            said[name] = f"{said.get(name, '')} {line[:6].strip()} {line[23:].strip()}".strip()
    return {name: " ".join(value.split()) for name, value in said.items()}
