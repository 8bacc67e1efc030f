"""Programs and services around a run, none of which `make ablation` needs unless it is told to."""

from __future__ import annotations

import netrc
import os
import shutil
import socket
import subprocess
from importlib.util import find_spec
from urllib.parse import urlsplit

from sag.data.check.report import Line

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "firefox", "open")

PATIENCE = 10.0
"""Seconds that a scheduler, or a server, has for an answer."""


def wandb_line() -> Line:
    """Where W&B's figures go; an account is looked for only where it is asked to send them."""
    mode = os.environ.get("WANDB_MODE", "")
    if mode != "online":
        said = f"offline, as WANDB_MODE={mode} says" if mode else "offline, the default: no account is needed"
        return Line("W&B", said, "ok")
    host = urlsplit(os.environ.get("WANDB_BASE_URL", "https://api.wandb.ai")).hostname or ""
    ways = ("wandb login", "or stay offline: unset WANDB_MODE, and send runs later by wandb sync")
    if not _logged_in(host):
        return Line("W&B", f"WANDB_MODE=online, and nobody is logged in to {host}", "broken", ways)
    try:
        socket.create_connection((host, 443), PATIENCE).close()
    except OSError as error:
        return Line("W&B", f"WANDB_MODE=online, and {host} does not answer ({error})", "look", ways[1:])
    return Line("W&B", f"online, logged in to {host}", "ok")


def _logged_in(host: str) -> bool:
    if os.environ.get("WANDB_API_KEY"):
        return True
    try:
        return netrc.netrc(os.environ.get("NETRC")).authenticators(host) is not None
    except (OSError, netrc.NetrcParseError):
        return False


def slurm_line() -> Line:
    """Whether a SLURM answers, and with what."""
    if not shutil.which("sinfo"):
        return Line("SLURM", "not here; only sag sweep --slurm needs it")
    command = ["sinfo", "--noheader", "--format=%P: %D %t, %G"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return Line("SLURM", f"sinfo has not answered in {PATIENCE:g} s", "look", ("is slurmctld up? scontrol ping",))
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        return Line("SLURM", "sinfo is here and fails", "look", (said, "is slurmctld up? scontrol ping"))
    partitions = tuple(line.replace(", (null)", "") for line in done.stdout.splitlines())
    if not find_spec("submitit"):
        return Line(
            "SLURM", "answers; sag sweep --slurm needs submitit", "look", (*partitions, "pip install 'sag[slurm]'")
        )
    return Line("SLURM", "answers", "ok", partitions)


def program_lines() -> list[Line]:
    """Programs that something is better with."""
    browser = next((name for name in BROWSERS if shutil.which(name)), None)
    film = find_spec("imageio_ffmpeg") is not None
    return [
        _program(
            "make", "runs make ablation", "without it: sag sweep sweeps/ablation.yaml, then sag report runs/ablation"
        ),
        _program("git", "notes the commit of a run", "without it metrics.json names no commit"),
        Line("browser", browser, "ok") if browser else Line("browser", "none; pages of sag view open on any machine"),
        Line("ffmpeg", "comes with imageio-ffmpeg", "ok")
        if film
        else Line("ffmpeg", "not for Python; MP4 films need it: pip install imageio-ffmpeg. GIFs need nothing"),
    ]


def _program(name: str, use: str, without: str) -> Line:
    return Line(name, use, "ok") if shutil.which(name) else Line(name, "not here", "look", (without,))
