"""Motions for other programs: BVH, animated glTF, and the axes that both expect."""

from sag.export.bvh import BvhForm, write_bvh
from sag.export.bvh_reader import BvhMotion, read_bvh
from sag.export.glb import View, write_glb
from sag.export.surface import Surface, surface_of
from sag.export.units import Unit
from sag.export.upright import CAMERA_UP, Upright, estimated_up, up_of

__all__ = [
    "CAMERA_UP",
    "BvhForm",
    "BvhMotion",
    "Surface",
    "Unit",
    "Upright",
    "View",
    "estimated_up",
    "read_bvh",
    "surface_of",
    "up_of",
    "write_bvh",
    "write_glb",
]
