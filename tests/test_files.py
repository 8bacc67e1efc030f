"""Folders that are needed while something is made."""

import platform
import subprocess
import sys
from pathlib import Path

import pytest

from sag.files import scratch_folder


def test_a_scratch_folder_is_gone_afterwards(tmp_path: Path):
    with scratch_folder(tmp_path / "new/cache") as scratch:
        (scratch / "part").write_text("half")
    assert list((tmp_path / "new").iterdir()) == []
    with pytest.raises(ValueError), scratch_folder(tmp_path / "cache") as scratch:
        raise ValueError
    assert not scratch.exists()


def test_what_a_killed_process_left_is_removed_and_what_a_living_one_needs_is_not(tmp_path: Path):
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    node = platform.node()
    names = (f"{node}.{gone.pid}", f"{node}.1", f"else.{gone.pid}")
    left, needed, other = (tmp_path / f".c.{name}" for name in names)
    for folder in (left, needed, other):
        folder.mkdir()
        (folder / "part").write_text("half")
    with scratch_folder(tmp_path / "c"):
        assert not left.exists() and needed.exists() and other.exists()
