"""Training of Motion FID's encoders."""

import lightning.pytorch as pl
import pytest
import torch
from toy_data import ToyDataModule

from sag.errors import SagError
from sag.methods import ERDTraining
from sag.methods.erd import random_clips
from sag.models.erd import MotionEncoders

WIDTH = 0.04


@pytest.fixture
def data(tmp_path) -> ToyDataModule:
    module = ToyDataModule(tmp_path)
    module.build()
    return module


def trainer(**options: object) -> pl.Trainer:
    quiet = {"logger": False, "enable_checkpointing": False, "enable_progress_bar": False}
    return pl.Trainer(accelerator="cpu", enable_model_summary=False, **{"max_epochs": 2, **quiet, **options})


def test_a_fit_leaves_encoders_that_know_their_data(data):
    training = ERDTraining(width=WIDTH)
    fit = trainer()
    fit.fit(training, data)
    assert {"train/erd/16", "train/erd/32", "train/erd/64"} <= set(fit.callback_metrics)
    loaded = MotionEncoders.load(data.encoder_path, "gta_im_19", data.cache.fingerprint)
    for name, weight in training.encoders.state_dict().items():
        assert torch.equal(weight, loaded.state_dict()[name]), name
    joints = data.training_motion.joints[:, 1:]
    relative = joints - joints[:, :1, 12:13]
    torch.testing.assert_close(loaded.of(64).mean, relative.mean((0, 1)))


def test_encoders_that_are_kept_cost_no_step(data):
    trainer().fit(ERDTraining(width=WIDTH), data)
    before = data.encoder_path.read_bytes()
    again = trainer()
    again.fit(ERDTraining(width=WIDTH, retrain=False), data)
    assert again.global_step == 0 and data.encoder_path.read_bytes() == before
    anew = trainer()
    anew.fit(ERDTraining(width=WIDTH, retrain=True), data)
    assert anew.global_step == 4 and data.encoder_path.read_bytes() != before
    with pytest.raises(SagError, match=r"width 0\.04, not 0\.05"):
        trainer().fit(ERDTraining(width=0.05, retrain=False), data)


def test_encoders_are_trained_where_there_are_none_to_keep(data):
    trainer().fit(ERDTraining(width=WIDTH, retrain=False), data)
    assert data.encoder_path.is_file()


def test_a_fast_dev_run_leaves_no_trace(data):
    trainer(fast_dev_run=True).fit(ERDTraining(width=WIDTH), data)
    assert not data.encoder_path.exists()


def test_it_can_be_tested_and_gives_features(data):
    training, run = ERDTraining(width=WIDTH), trainer()
    run.fit(training, data)
    (errors,) = run.test(training, data, verbose=False)
    assert set(errors) == {"test/erd/16", "test/erd/32", "test/erd/64"}
    features = run.predict(training, data)[0]
    assert features[16, 64].shape == (4, training.encoders.dimension)


def test_a_limited_fit_does_not_replace_encoders(data, capsys):
    trainer().fit(ERDTraining(width=WIDTH), data)
    before = data.encoder_path.read_bytes()
    assert str(data.encoder_path) in capsys.readouterr().out
    trainer(limit_train_batches=1).fit(ERDTraining(width=WIDTH), data)
    assert data.encoder_path.read_bytes() == before
    assert "left as it is" in capsys.readouterr().out


def test_a_test_reads_what_was_trained_on_this_data(data):
    with pytest.raises(SagError, match=r"erd-toy-.* missing"):
        trainer().test(ERDTraining(width=WIDTH), data, verbose=False)
    training = ERDTraining(width=WIDTH)
    trainer().fit(training, data)
    fresh = ERDTraining(width=WIDTH)
    trainer().test(fresh, data, verbose=False)
    for name, weight in training.encoders.state_dict().items():
        assert torch.equal(weight, fresh.encoders.state_dict()[name]), name


def test_noise_grows_from_the_first_step_to_the_last(data):
    seen = []

    class Watched(ERDTraining):
        def training_step(self, batch, batch_idx):
            seen.append(self.noise)
            return super().training_step(batch, batch_idx)

    trainer().fit(Watched(width=WIDTH, first_noise=0.1, last_noise=0.5), data)
    assert seen == pytest.approx([0.1, 0.2, 0.3, 0.4])


def test_gradients_are_clipped_for_each_encoder(data):
    norms = []

    class Watched(ERDTraining):
        def on_before_zero_grad(self, optimizer):
            for network in self.encoders.networks.values():
                gradients = [p.grad for p in network.parameters() if p.grad is not None]
                norms.append(sum(float(g.square().sum()) for g in gradients) ** 0.5)

    trainer(max_epochs=1).fit(Watched(width=WIDTH, clip_norm=1e-4), data)
    assert max(norms) == pytest.approx(1e-4, rel=1e-2)


def test_random_clips_are_consecutive_frames_of_their_motion():
    motions = torch.arange(64.0)[None, :, None, None] + 1000 * torch.arange(200.0)[:, None, None, None]
    clips = random_clips(motions.expand(-1, -1, 2, 3), 16)
    assert clips.shape == (200, 16, 2, 3)
    assert (clips.diff(dim=1) == 1).all() and torch.equal(clips[:, 0, 0, 0] // 1000, torch.arange(200.0))
    starts = clips[:, 0, 0, 0] % 1000
    assert starts.min() == 0 and starts.max() == 48


def test_another_skeleton_is_refused(data):
    with pytest.raises(SagError, match=r"model\.skeleton is 'prox_16' but the data set's is 'gta_im_19'"):
        trainer().fit(ERDTraining("prox_16", width=WIDTH), data)
