"""GTA-IM (Cao et al., ECCV 2020): people in rooms of a game, from the files its authors send on request."""

from sag.data.gta_im.module import GtaImDataModule

__all__ = ["GtaImDataModule"]
