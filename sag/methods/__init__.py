"""Systems that train, or that only sample, under one protocol."""

from sag.methods.cao import Cao
from sag.methods.csgn import CSGN
from sag.methods.erd import ERDTraining
from sag.methods.ground_truth import GroundTruth
from sag.methods.hp_gan import HPGAN
from sag.methods.recorded import Recorded
from sag.methods.sag import SAG
from sag.methods.two_stage import TwoStage

__all__ = ["CSGN", "HPGAN", "SAG", "Cao", "ERDTraining", "GroundTruth", "Recorded", "TwoStage"]
