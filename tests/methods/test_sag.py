from dataclasses import replace
from pathlib import Path

import pytest
import torch
from toy_data import ToyDataModule

from sag.components import Components, Network
from sag.errors import SagError
from sag.methods import SAG
from sag.skeleton import GTA_IM_19
from sag.trainer import Trainer

SMALL = Network(width=0.05, critic_norm="layer")


def trainer(folder: Path, epochs: int = 1, **options) -> Trainer:
    quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False}
    never = {"check_val_every_n_epoch": 99, "num_sanity_val_steps": 0, "enable_checkpointing": False}
    return Trainer(max_epochs=epochs, default_root_dir=folder, accelerator="cpu", **quiet, **never, **options)


def method(toy: ToyDataModule, **options) -> SAG:
    return SAG(network=SMALL, image_size=toy.image_size, **options)


def trained(toy: ToyDataModule, folder: Path, seed: int = 0, **options) -> SAG:
    torch.manual_seed(seed)
    made = method(toy, **options)
    trainer(folder).fit(made, toy)
    return made


def test_one_seed_gives_one_result(toy: ToyDataModule, tmp_path: Path, batch) -> None:
    first, again, other = (trained(toy, tmp_path, seed, average=0.9) for seed in (3, 3, 4))
    state, same = first.state_dict(), again.state_dict()
    assert all(torch.equal(state[name], same[name]) for name in state)
    name = "sampler.generator.trajectory.out.weight"
    assert not torch.equal(state[name], other.state_dict()[name])
    samples = [m.eval().sample(batch, torch.Generator().manual_seed(1)).joints for m in (first, again)]
    assert torch.equal(*samples)


def test_bfloat16_is_the_encoders_alone(toy: ToyDataModule, tmp_path: Path, batch) -> None:
    made, seen = method(toy), {}
    watched = {**made.critics, "encoder": made.sampler.encoder.resnet, "generator": made.sampler.generator.pose}
    for name, module in watched.items():
        module.register_forward_hook(lambda _, given, found, name=name: seen.setdefault(name, set()).add(found.dtype))
    trainer(tmp_path, precision="bf16-mixed").fit(made, toy)
    assert seen.pop("encoder") == {torch.bfloat16}
    assert len(seen) == 5 and all(types == {torch.float32} for types in seen.values())
    assert made.eval().sample(batch).joints.isfinite().all()


def test_critic_steps_delay_the_generator(toy: ToyDataModule, tmp_path: Path) -> None:
    assert int(trained(toy, tmp_path, critic_steps=1).generator_steps) == 2
    assert int(trained(toy, tmp_path, critic_steps=2).generator_steps) == 1


def test_critic_steps_are_counted_over_epochs(toy: ToyDataModule, tmp_path: Path) -> None:
    made = method(toy, critic_steps=3)
    trainer(tmp_path, epochs=3).fit(made, toy)  # 2 batches an epoch
    assert int(made.generator_steps) == 2


def test_the_average_follows_the_generator(toy: ToyDataModule, tmp_path: Path) -> None:
    made = trained(toy, tmp_path, average=0.5)
    raw, averaged = made.sampler, made.averaged[0].module
    name = "generator.trajectory.out.weight"
    assert not torch.equal(raw.get_parameter(name), averaged.get_parameter(name))
    assert torch.equal(raw.scale.pose_std, averaged.scale.pose_std)
    assert "generator.trajectory.blocks.0.2.running_mean" in dict(averaged.named_buffers())
    assert not any(p.requires_grad for p in made.averaged.parameters())
    assert list(made.variants()) == ["raw"]
    assert not method(toy).variants()


@pytest.mark.parametrize("average", [-0.1, 1.0])
def test_an_impossible_average_is_refused(toy: ToyDataModule, average: float) -> None:
    with pytest.raises(SagError, match="average"):
        method(toy, average=average)


def test_an_unknown_weight_is_refused_by_name(toy: ToyDataModule) -> None:
    with pytest.raises(SagError, match="projeciton"):
        method(toy, weights={"projeciton": 2.0})


def test_a_weight_of_zero_silences_its_loss(toy: ToyDataModule, tmp_path: Path) -> None:
    silent = trained(toy, tmp_path, components=Components(projection=False, context=False), weights={"depth": 0.0})
    torch.manual_seed(0)
    before = method(toy, components=Components(projection=False, context=False)).depth
    after = silent.depth
    assert all(torch.equal(a, b) for a, b in zip(before.parameters(), after.parameters()))


def test_a_checkpoint_brings_everything_back(toy: ToyDataModule, tmp_path: Path, batch) -> None:
    made = trained(toy, tmp_path, average=0.9)
    made.trainer.save_checkpoint(tmp_path / "x.ckpt")
    fresh = method(toy, average=0.9)
    trainer(tmp_path, fast_dev_run=1).test(fresh, toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)
    assert fresh.trained
    first, second = (m.eval().sample(batch, torch.Generator().manual_seed(1)).joints for m in (made, fresh))
    assert torch.equal(first, second)


def test_a_checkpoint_of_another_row_is_refused(toy: ToyDataModule, tmp_path: Path) -> None:
    made = trained(toy, tmp_path)
    made.trainer.save_checkpoint(tmp_path / "x.ckpt")
    other = method(toy, components=Components(context=False))
    with pytest.raises(SagError, match=r"does not fit this SAG: critics\.context"):
        trainer(tmp_path, fast_dev_run=1).test(other, toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)


def test_a_checkpoint_for_another_skeleton_is_refused(toy: ToyDataModule, tmp_path: Path) -> None:
    """As many joints and groups, so that every weight would fit, but in another order."""
    made = trained(toy, tmp_path)
    made.skeleton = replace(GTA_IM_19, name="turned", joints=GTA_IM_19.joints[::-1])
    made.trainer.save_checkpoint(tmp_path / "x.ckpt")
    with pytest.raises(SagError, match=r"trained on the skeleton turned \(19 joints\).*--data\.init_args\.skeleton"):
        trainer(tmp_path, fast_dev_run=1).test(method(toy), toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)


@pytest.mark.parametrize("damage", ["missing", "truncated", "no state"])
def test_a_wrong_checkpoint_is_named(toy: ToyDataModule, tmp_path: Path, damage: str) -> None:
    path = tmp_path / "x.ckpt"
    if damage == "truncated":
        trained(toy, tmp_path).trainer.save_checkpoint(path)
        path.write_bytes(path.read_bytes()[:-1000])
    if damage == "no state":
        torch.save({"weights": torch.zeros(3)}, path)
    with pytest.raises(SagError, match=r"x\.ckpt"):
        trainer(tmp_path, fast_dev_run=1).test(method(toy), toy, ckpt_path=path, verbose=False)


def test_a_checkpoint_holds_only_tensors_and_plain_types(toy: ToyDataModule, tmp_path: Path) -> None:
    trained(toy, tmp_path, average=0.9).trainer.save_checkpoint(tmp_path / "x.ckpt")
    assert "state_dict" in torch.load(tmp_path / "x.ckpt", weights_only=True)
    assert [p.name for p in tmp_path.iterdir()] == ["x.ckpt"]


def test_untrained_weights_are_not_tested(toy: ToyDataModule, tmp_path: Path) -> None:
    with pytest.raises(SagError, match="--ckpt_path"):
        trainer(tmp_path).test(method(toy), toy, verbose=False)


def test_a_missing_encoder_is_named_with_the_way_out(tmp_path: Path) -> None:
    toy = ToyDataModule(tmp_path / "cache")
    made = trained(toy, tmp_path)
    with pytest.raises(SagError, match=r"erd-toy-.*methods/erd\.yaml"):
        trainer(tmp_path).test(made, toy, verbose=False)
