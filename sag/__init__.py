"""Scene-aware human motion synthesis: from one picture and a first pose to plausible 3D motions."""

__version__ = "0.1.0"
