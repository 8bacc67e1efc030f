"""All 16 rows: what is built, that it trains and tests, and that only one file asks for the letters."""

import dataclasses
import itertools
import re
from pathlib import Path

import pytest
import torch

import sag
from sag.components import Components, Network, build_critics, build_depth, build_encoder, build_generator
from sag.methods import SAG
from sag.models.generators import JointGenerator, SeparateGenerator
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.trainer import Trainer

ROWS = [Components(*on) for on in itertools.product([False, True], repeat=4)]
SMALL = Network(width=0.05, critic_norm="layer")


def letters(components: Components) -> str:
    return components.letters


def test_sixteen_names() -> None:
    assert len({row.letters for row in ROWS}) == 16
    assert Components().letters == "mdpc"
    assert ROWS[0].letters == "none"


@pytest.mark.parametrize("components", ROWS, ids=letters)
def test_what_is_built(components: Components) -> None:
    scale = MotionScale(19, GTA_IM_19.root_index)
    generator = build_generator(components, SMALL, GTA_IM_19, scale)
    assert isinstance(generator, SeparateGenerator if components.separate else JointGenerator)
    wanted = {"trajectory", "pose"} if components.separate else {"motion"}
    wanted |= {"projection"} if components.projection else set()
    wanted |= {"context"} if components.context else set()
    assert set(build_critics(components, SMALL, GTA_IM_19, scale)) == wanted
    supervised = bool(list(build_depth(components, SMALL, (36, 64)).parameters()))
    assert supervised == components.depth


@pytest.mark.parametrize("components", ROWS, ids=letters)
def test_every_row_trains_and_tests(components: Components, toy) -> None:
    method = SAG(components, SMALL, image_size=toy.image_size, average=0.9)
    before = {name: p.clone() for name, p in method.named_parameters()}
    trainer = Trainer(fast_dev_run=2, accelerator="cpu", enable_progress_bar=False, enable_model_summary=False)
    trainer.run(method, toy)
    # A shift of all scores cancels in the Wasserstein loss.
    shifts = ("network.out.bias", "network.score.bias")
    learning = {n: p for n, p in method.named_parameters() if p.requires_grad and not n.endswith(shifts)}
    still = [n for n, p in learning.items() if torch.equal(p, before[n])]
    assert not still, "every parameter learns in every row"
    figures = {name: value for name, value in trainer.callback_metrics.items() if name != "test/collisions/ratio"}
    assert all(value.isfinite() for value in figures.values()), "a ratio is none where nothing collides elsewhere"
    assert "test/non_collision/average" in trainer.callback_metrics


@pytest.mark.parametrize("components", ROWS, ids=letters)
def test_losses_are_logged_under_their_names(components: Components, toy) -> None:
    method = SAG(components, SMALL, image_size=toy.image_size)
    trainer = Trainer(
        max_epochs=1, limit_train_batches=1, accelerator="cpu", logger=False, enable_checkpointing=False,
        enable_progress_bar=False, enable_model_summary=False, check_val_every_n_epoch=9, num_sanity_val_steps=0,
    )  # fmt: skip
    trainer.fit(method, toy)
    logged = {name for name in trainer.callback_metrics if name.startswith("train/")}
    wanted = {"train/generator_step"} | ({"train/generator/depth"} if components.depth else set())
    for name in method.critics:
        wanted |= {f"train/{kind}/{name}" for kind in ("critic", "penalty", "generator")}
    assert logged == wanted


def test_the_context_critic_sees_decoded_depth_when_asked(batch) -> None:
    feature = torch.randn(4, SMALL.generator_sizes.feature)
    decoded, losses = build_depth(Components(), SMALL, (36, 64))(feature, batch.scene)
    assert not torch.equal(decoded.depth, batch.scene.depth)
    assert not decoded.depth.requires_grad
    assert losses["depth"].requires_grad
    given, _ = build_depth(Components(), Network(width=0.05, context_depth="given"), (36, 64))(feature, batch.scene)
    assert torch.equal(given.depth, batch.scene.depth)
    without, nothing = build_depth(Components(depth=False), SMALL, (36, 64))(feature, batch.scene)
    assert torch.equal(without.depth, batch.scene.depth)
    assert nothing == {}


def test_a_blind_row_trains_and_samples_alike_in_every_scene(toy) -> None:
    blind = dataclasses.replace(SMALL, blind=True)
    method = SAG(Components(depth=False, projection=False, context=False), blind, image_size=toy.image_size)
    trainer = Trainer(fast_dev_run=2, accelerator="cpu", enable_progress_bar=False, enable_model_summary=False)
    trainer.run(method, toy)
    batch = next(iter(toy.test_dataloader()))
    brighter = dataclasses.replace(batch.scene, image=1 - batch.scene.image)
    with torch.no_grad():
        first, second = (method.sampler(s, batch.motion, torch.manual_seed(0)) for s in (batch.scene, brighter))
    assert torch.equal(first.joints, second.joints)


def test_a_seeing_row_samples_differently_elsewhere(batch) -> None:
    scale = MotionScale(19, GTA_IM_19.root_index)
    generator = build_generator(Components(), SMALL, GTA_IM_19, scale)
    sampler = Sampler(build_encoder(SMALL), generator, scale).eval()
    other = dataclasses.replace(batch.scene, image=1 - batch.scene.image)
    with torch.no_grad():
        first, second = (sampler(s, batch.motion, torch.manual_seed(0)) for s in (batch.scene, other))
    assert not torch.equal(first.joints, second.joints)


def test_width_scales_every_count() -> None:
    assert Network().channels(64, 256) == (64, 256)
    assert Network(width=0.25).channels(64, 256, 32, 8) == (16, 64, 16, 8)


def test_only_one_file_asks_for_the_letters() -> None:
    asking = re.compile(r"\bif\b[^\n:]*components\.(separate|depth|projection|context)")
    package = Path(sag.__file__).parent
    files = {str(p.relative_to(package)) for p in package.rglob("*.py") if asking.search(p.read_text())}
    assert files == {"components.py"}
