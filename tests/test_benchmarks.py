"""The benchmarks run in a tiny form, and a claim that is not met is an error."""

import json

import pytest
import torch

from benchmarks.__main__ import BENCHMARKS, main
from benchmarks.brute_force import NearBody, by_columns, by_numpy, by_torch
from benchmarks.claim import Claim, faster
from benchmarks.collisions import RADII, Furnished
from benchmarks.flops import flops
from benchmarks.known_sets import known_pairs
from benchmarks.paired import Pairing, Work, paired
from benchmarks.peers import _torchvision_or_stand_in
from benchmarks.training_step import both_steps, windows
from sag.components import Network
from sag.types import Tensors


def claim(found: float, asked: float | None, at_least: bool = True) -> Claim:
    return Claim("a claim", "a peer", found, asked, "1 ms", "2 ms", at_least)


@pytest.mark.parametrize("name", BENCHMARKS)
def test_measures_something(name, tmp_path, capsys):
    main(["--only", name, "--quick", "--out", str(tmp_path / "results.json")])
    written = json.loads((tmp_path / "results.json").read_text())
    assert written["claims"] and written["versions"]["torch"] and written["machine"]["processor"]
    measured = [c for c in written["claims"] if "not installed" not in c["note"]]
    assert measured and all(c["found"] is not None and c["found"] >= 0 for c in measured)
    exact = [c for c in measured if c["unit"] == " differ"]
    assert all(c["met"] for c in exact) and ("differ" in capsys.readouterr().out) == bool(exact)


@pytest.mark.parametrize(
    ("found", "asked", "at_least", "status"),
    [
        (2, 3, True, 1),
        (3, 3, True, 0),
        (1, 0, False, 1),
        (0, 0, False, 0),
        (float("nan"), 3, True, 1),
        (2, None, True, 0),
    ],
)
def test_exits_with_an_error_when_a_claim_is_not_met(found, asked, at_least, status, tmp_path):
    fake = {"fake": lambda quick, say: iter([claim(1, 1), claim(found, asked, at_least)])}
    assert main(["--out", str(tmp_path / "results.json")], fake) == status


def test_the_ratio_is_the_median_of_pairs():
    pairing = Pairing(ours=[1, 2, 1], theirs=[2, 10, 9])
    assert pairing.ratios == [2, 5, 9] and pairing.ratio == 5
    assert not faster("", "", pairing, least=6).met and faster("", "", pairing, least=5).spread == (2, 9)


def test_rounds_pair_what_both_returned_and_the_order_alternates():
    ran = []
    works = [Work(lambda n, who=who: ran.append((n, who)) or (n, who)) for who in ("ours", "theirs")]
    pairing = paired(works[0], {"peer": works[1]}, rounds=2)["peer"]
    assert pairing.found == [((0, "ours"), (0, "theirs")), ((1, "ours"), (1, "theirs"))]
    assert [who for _, who in ran[2:]] == ["theirs", "ours", "ours", "theirs"]


def test_all_forms_of_brute_force_agree():
    room = Furnished.of(3, (54, 96), 40)
    touching = 0
    for frame in range(len(room.bodies)):
        ends = room.ends(frame)
        counts = [f(room.points, *ends, RADII).tolist() for f in (by_numpy, by_torch, by_columns)]
        assert counts[0] == counts[1] == counts[2] == NearBody(room.points).counts(*ends, RADII).tolist()
        touching += any(counts[0])
    assert touching > 5


def test_known_pairs_have_the_moments_that_their_distance_rests_on():
    for name, real, generated, distance in known_pairs(dimension=12, rank=4, seed=0):
        means = (real.mean(0) - generated.mean(0)).square().sum()
        traces = [float(x.T.cov().trace()) for x in (real, generated)]
        low = float(means) + (traces[0] ** 0.5 - traces[1] ** 0.5) ** 2
        assert low - 1e-9 <= distance <= float(means) + sum(traces) + 1e-9, name
        assert (distance < 1e-12) == (name == "identical")


def doubled(tensors):
    return tensors._map(lambda x: doubled(x) if isinstance(x, Tensors) else x.double() if x.is_floating_point() else x)


def test_both_training_steps_are_the_same_step():
    torch.set_default_dtype(torch.float64)
    try:
        batch = doubled(windows(2, (36, 64)))
        steps = both_steps(Network(width=0.05, critic_norm="layer"), (36, 64), 2, batch.motion)
        for step in steps:
            torch.manual_seed(1)
            step.double().whole(batch)
    finally:
        torch.set_default_dtype(torch.float32)
    ours, plain = ([*step.critics.parameters(), *(p.grad for p in step.sampler.parameters())] for step in steps)
    assert len(ours) == len(plain) > 150
    for a, b in zip(ours, plain):
        torch.testing.assert_close(a, b, rtol=1e-6, atol=1e-6)


def test_arithmetic_of_a_penalty_is_counted():
    weight, x = torch.randn(5, 3, requires_grad=True), torch.randn(7, 5, requires_grad=True)

    def run(number):
        (gradient,) = torch.autograd.grad((x @ weight).square().sum(), x, create_graph=True)
        gradient.square().sum().backward()

    product = 2 * 7 * 5 * 3
    assert flops(Work(lambda number: x @ weight)) == product
    assert flops(Work(run)) >= 4 * product


def test_the_stand_in_leaves_nothing_behind():
    import sys

    before = {name for name in sys.modules if name.startswith("torchvision")}
    with _torchvision_or_stand_in():
        import torchvision

        class Network(torchvision.models.inception.InceptionA):
            pass

    assert {name for name in sys.modules if name.startswith("torchvision")} == before or before
