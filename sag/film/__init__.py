"""Motions as pictures and films, drawn without a display: in the picture that was given, and from beside it."""

from sag.film.encoding import write_film
from sag.film.orbit import orbit_frames
from sag.film.overlay import overlay_frames
from sag.film.stage import Stage, stage_of
from sag.film.strip import strip

__all__ = ["Stage", "orbit_frames", "overlay_frames", "stage_of", "strip", "write_film"]
