"""Slots share a machine's cores and GPUs among rows."""

import pytest

from sag.errors import SagError
from sag.sweep import main, process
from sag.sweep.slots import Slot, slots, visible_gpus


@pytest.fixture(autouse=True)
def eight_cores(monkeypatch):
    monkeypatch.setattr(process, "cores", lambda: 8)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)


@pytest.mark.parametrize(
    ("visible", "jobs", "each", "wanted"),
    [
        ("", None, None, [Slot(4), Slot(4)]),
        ("", 4, None, [Slot(2)] * 4),
        ("", 16, None, [Slot(1)] * 16),
        ("0,1,2,3", None, None, [Slot(2, "0"), Slot(2, "1"), Slot(2, "2"), Slot(2, "3")]),
        ("0,1,2,3", None, 2, [Slot(4, "0,1"), Slot(4, "2,3")]),
        ("4,7", 1, None, [Slot(8, "4")]),
        ("4,7", 4, None, [Slot(2, "4"), Slot(2, "7"), Slot(2, "4"), Slot(2, "7")]),
        ("0,1,2", None, 2, [Slot(8, "0,1")]),
        ("0,1", None, 0, [Slot(8, "")]),
        ("GPU-8f2,MIG-1c", None, None, [Slot(4, "GPU-8f2"), Slot(4, "MIG-1c")]),
    ],
)
def test_there_is_one_for_each_gpu_or_core_group(monkeypatch, visible, jobs, each, wanted):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", visible)
    assert slots(jobs, each) == wanted


def test_more_gpus_than_there_are_is_refused(monkeypatch):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "0")
    with pytest.raises(SagError, match="--gpus 2: this machine shows 1 GPUs; ask for fewer, or add --slurm"):
        slots(gpus_each=2)


def test_gpus_are_those_that_the_driver_lists_where_none_are_chosen(monkeypatch, tmp_path):
    monkeypatch.delenv("CUDA_VISIBLE_DEVICES", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert visible_gpus() == [], "no driver"
    (tmp_path / "nvidia-smi").write_text("#!/bin/sh\necho 0\necho 1\n")
    (tmp_path / "nvidia-smi").chmod(0o755)
    assert visible_gpus() == ["0", "1"]
    (tmp_path / "nvidia-smi").write_text("#!/bin/sh\necho no devices were found\nexit 6\n")
    assert visible_gpus() == [], "a driver without a GPU"
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "-1")
    assert visible_gpus() == []


def test_rows_at_the_same_time_have_different_gpus(workplace, monkeypatch):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "0,1")
    workplace.wishes(**{row: {"seconds": 0.5} for row in ("ground_truth", "none", "c", "m", "mc", "blind")})
    assert main(["sweep.yaml"]) == 0
    calls = {call["row"]: call["environment"] for call in workplace.calls()}
    assert {calls[row]["CUDA_VISIBLE_DEVICES"] for row in calls} == {"0", "1"}
    assert {call["OMP_NUM_THREADS"] for call in calls.values()} == {"4"}
    spans = [workplace.status(row) for row in calls]
    for one in spans:
        for other in spans:
            together = one["started"] < other["started"] < one["ended"]
            assert not together or one["gpus"] != other["gpus"]
