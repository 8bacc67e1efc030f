"""A photograph as a data set of one window, so that whatever shows or exports windows shows and exports it too."""

from sag.data.photo.module import PhotoDataModule, write_photo
from sag.data.photo.photograph import Photograph, read_photograph
from sag.data.photo.place import Place
from sag.data.photo.pose import read_pose, standing_pose

__all__ = ["PhotoDataModule", "Photograph", "Place", "read_photograph", "read_pose", "standing_pose", "write_photo"]
