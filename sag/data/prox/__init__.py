"""PROX (Hassan et al., ICCV 2019): people in 12 scanned rooms before a Kinect, as its users download it."""

from sag.data.prox.module import ProxDataModule

__all__ = ["ProxDataModule"]
