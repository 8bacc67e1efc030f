"""What a test measures, whatever made the motions: the paper's figures, and beside them ours."""

from sag.scoring.evaluation import Evaluation
from sag.scoring.floors import Floors
from sag.scoring.groups import Groups
from sag.scoring.scores import Scores

__all__ = ["Evaluation", "Floors", "Groups", "Scores"]
