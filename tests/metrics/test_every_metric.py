"""Every metric of the package in use as torchmetrics has it: clones, pickles, plots, forward, parts, low precision."""

import pickle
from typing import Any

import jaxtyping
import matplotlib
import numpy as np
import pytest
import torch
from metric_inputs import (
    WINDOWS,
    as_type,
    asked,
    built,
    every_metric,
    fed,
    numbers,
    picked,
    toy_inputs,
    usual_settings,
)  # fmt: skip

from sag.errors import SagError
from sag.metrics.sides import TwoSides

matplotlib.use("Agg")
EVERY = pytest.mark.parametrize("kind", every_metric(), ids=lambda kind: kind.__name__)
PARTS = (slice(0, 5), slice(5, WINDOWS))


def near(computed: Any) -> Any:
    """Sums in another order: distances of so few motions from each other are differences of large numbers."""
    return pytest.approx(numbers(computed), rel=1e-6, abs=1e-9)


@pytest.fixture(scope="module")
def settings() -> dict[str, Any]:
    return usual_settings()


@pytest.fixture(scope="module")
def inputs() -> dict[str, Any]:
    return toy_inputs()


@EVERY
def test_says_its_name_which_way_is_better_and_what_it_is_to_torchmetrics(kind):
    own = [base for base in kind.__mro__ if base.__module__.startswith("sag.")]
    assert any("higher_is_better" in vars(base) for base in own) and kind.title
    assert kind.higher_is_better in (True, False, None)
    assert kind.is_differentiable is False and kind.full_state_update is False


@EVERY
def test_plots_a_figure(kind, settings, inputs):
    figure, _ = fed(built(kind, settings), inputs).plot()
    assert isinstance(figure, matplotlib.figure.Figure)
    matplotlib.pyplot.close(figure)


@EVERY
def test_starts_anew_after_reset_and_survives_a_pickle_and_a_clone(kind, settings, inputs):
    metric = fed(built(kind, settings), inputs)
    expected = numbers(metric.compute())
    for copied in (metric.clone(), pickle.loads(pickle.dumps(metric))):
        assert numbers(copied.compute()) == expected
        fed(copied, {**inputs, "samples": 2 * inputs["samples"], "joints": 3 * inputs["joints"]})
    assert numbers(metric.compute()) == expected
    metric.reset()
    assert numbers(fed(metric, inputs).compute()) == expected


@EVERY
def test_parts_of_several_processes_add_up(kind, settings, inputs):
    first, second = (built(kind, settings) for _ in PARTS)
    for metric, part in zip((first, second), PARTS):
        metric.update(**asked(kind, picked(inputs, part)))
    first.merge_state(second)
    assert numbers(first.compute()) == near(fed(built(kind, settings), inputs).compute())


@pytest.mark.parametrize("with_index", [True, False])
@EVERY
def test_forward_over_batches_adds_what_update_adds(kind, with_index, settings, inputs):
    given = {name: value for name, value in inputs.items() if with_index or name != "index"}
    called, updated = built(kind, settings), built(kind, settings)
    for part in PARTS:
        some = asked(kind, picked(given, part))
        found = numbers(called(**some))
        updated.update(**some)
        if "real" not in some and (with_index or part.start == 0):  # two sides of unequal size are not compared
            alone = built(kind, settings)
            alone.update(**some)
            assert found == near(alone.compute())
    assert numbers(called.compute()) == near(updated.compute())
    assert numbers(called.compute()) == near(fed(built(kind, settings), given).compute())


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16, torch.float16], ids=str)
@EVERY
def test_reads_any_precision_and_sums_in_float64(kind, dtype, settings, inputs):
    settings = {**settings, "encoders": usual_settings()["encoders"].float()}
    metric = fed(built(kind, settings), as_type(inputs, dtype))
    same = fed(built(kind, settings), as_type(as_type(inputs, dtype), torch.float32))
    assert numbers(metric.compute()) == pytest.approx(numbers(same.compute()), rel=1e-5, abs=1e-9)
    states = [getattr(metric, name) for name in metric._defaults]
    tensors = [state for each in states for state in (each if isinstance(each, list) else [each])]
    assert all(state.dtype in (torch.float64, torch.int64) for state in tensors)


@pytest.mark.parametrize("name", ["samples", "joints", "world"])
@EVERY
def test_refuses_motions_of_other_dimensions(kind, name, settings, inputs, monkeypatch):
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)  # as it is where shapes are not checked
    given = asked(kind, inputs)
    for missing in range(2) if name in given else ():
        few = {**given, name: given[name][0] if missing else given[name][0, 0]}
        with pytest.raises(SagError, match=r"needs joints of shape|moved elsewhere"):
            built(kind, settings).update(**few)


@EVERY
def test_a_run_in_low_precision_changes_no_figure(kind, settings, inputs):
    settings = {**settings, "encoders": usual_settings()["encoders"].float()}
    inputs = as_type(inputs, torch.float32)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        metric = fed(built(kind, settings), inputs)
        found = numbers(metric.compute())
    assert found == numbers(fed(built(kind, settings), inputs).compute())


@pytest.mark.parametrize("kind", [kind for kind in every_metric() if issubclass(kind, TwoSides)])
def test_counts_one_truth_value_however_it_is_given(kind, settings, inputs):
    found, one, each = [], torch.tensor(True), torch.ones(WINDOWS, dtype=torch.bool)
    for true, false in ((True, False), (np.bool_(True), np.bool_(False)), (one, ~one), (each, ~each)):
        metric = built(kind, settings)
        for real, jitter in ((true, 0), (false, 1)):
            moved = inputs["joints"] + 0.05 * jitter * torch.arange(65)[:, None, None] % 0.3
            metric.update(**asked(kind, {**inputs, "joints": moved, "real": real}))
        found.append(numbers(metric.compute()))
    assert found[0] == found[1] == found[2] == found[3]
