"""Systems that train, or that only sample, under one protocol."""

from sag.methods.erd import ERDTraining
from sag.methods.ground_truth import GroundTruth
from sag.methods.recorded import Recorded
from sag.methods.sag import SAG

__all__ = ["SAG", "ERDTraining", "GroundTruth", "Recorded"]
