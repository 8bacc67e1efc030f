"""Motion FID finds the real side's roots once, and never takes those of another real side."""

import pickle
import warnings

import pytest
import torch
from clip_toys import floats

from sag.metrics import MotionFID
from sag.metrics.fid.clips import ClipFeatures, clip_features
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


@pytest.fixture(scope="module")
def sides(encoders, motions, others) -> tuple[ClipFeatures, ClipFeatures]:
    """Features of real and of generated motions."""
    return clip_features(encoders, motions, ROOT), clip_features(encoders, others, ROOT)


def filled(encoders: MotionEncoders, real: ClipFeatures, generated: ClipFeatures, **options) -> MotionFID:
    metric = MotionFID(encoders, ROOT, **options)
    metric.update_features(real, real=True)
    metric.update_features(generated, real=False)
    return metric


@pytest.fixture
def rooted(monkeypatch) -> list[int]:
    """Grows by one for each root that is found."""
    found: list[int] = []
    plain = torch.linalg.cholesky_ex

    def counted(*args, **options):
        found.append(1)
        return plain(*args, **options)

    monkeypatch.setattr(torch.linalg, "cholesky_ex", counted)
    return found


@pytest.mark.parametrize("reset_real", [True, False])
def test_found_once_while_the_real_side_stays(encoders, sides, rooted, reset_real):
    real, generated = sides
    metric = filled(encoders, real, generated, reset_real=reset_real)
    first = floats(metric.compute())
    assert len(rooted) == 18
    metric.update_features(generated, real=False)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        metric.unequal = "warn"
        metric.compute()
    metric.reset()
    if reset_real:
        metric.update_features(real, real=True)
    metric.update_features(generated, real=False)
    assert floats(metric.compute()) == pytest.approx(first, abs=1e-12)
    assert len(rooted) == 18


def test_never_stale(encoders, sides):
    real, generated = sides
    third = {key: 1.5 * features for key, features in real.items()}
    expected = floats(filled(encoders, third, generated).compute())

    def by_reset(metric: MotionFID) -> None:
        metric.reset()
        metric.update_features(third, real=True)
        metric.update_features(generated, real=False)

    def by_sharing(metric: MotionFID) -> None:
        metric.share_real(filled(encoders, third, real))

    def by_state_dict(metric: MotionFID) -> None:
        source = filled(encoders, third, generated)
        source.persistent(True)
        metric._computed = None
        metric.load_state_dict(source.state_dict())

    def in_place(metric: MotionFID) -> None:
        metric._computed = None
        metric.real_sum *= 1.5
        metric.real_products *= 2.25

    for change in (by_reset, by_sharing, by_state_dict, in_place):
        metric = filled(encoders, real, generated)
        metric.compute()
        for copied in (metric.clone(), pickle.loads(pickle.dumps(metric)), metric):
            change(copied)
            assert floats(copied.compute()) == pytest.approx(expected, abs=1e-9), change.__name__


def test_not_in_pickles(encoders, sides):
    metric = filled(encoders, *sides)
    before = len(pickle.dumps(metric))
    metric.compute()
    assert len(pickle.dumps(metric)) < before + 5_000
