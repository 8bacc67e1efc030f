"""The embedded data set: synthetic furnished rooms with people who walk, sit and stand in them."""

from sag.data.rooms.build import build_rooms, load_contact
from sag.data.rooms.geometry import RoomGeometry, load_geometry
from sag.data.rooms.module import RoomsDataModule
from sag.data.rooms.recipe import Recipe

__all__ = ["Recipe", "RoomGeometry", "RoomsDataModule", "build_rooms", "load_contact", "load_geometry"]
