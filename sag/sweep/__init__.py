"""Sweeps: every row of an ablation trained and tested in a process of its own, from one W&B sweep file."""

from sag.sweep.command_line import main

__all__ = ["main"]
