"""Made-up runs on disk: only their form is like that of real ones."""

import copy
import json
from pathlib import Path

import pytest

from sag.letters import components_of

COMPLETE = {
    "method": "SAG",
    "seed": 0,
    "data": {
        "name": "rooms", "fingerprint": "abcdef123456", "fps": 30.0,
        "windows": {"train": 2322, "val": 300, "test": 1100}, "notes": [],
    },
    "protocol": {
        "motions": 1100, "collision_frames": 10000, "cloud_points": 140000.0, "encoders": "e5c0de",
        "skeleton": "gta_im_19",
    },
    "steps": 700,
    "seconds": {"fit": 150.0, "test": 20.0},
    "parameters": 1234567,
    "versions": {"sag": "0.1.0", "torch": "2.13.0"},
    "commit": "b33a343",
}  # fmt: skip


def figures(fid: float, share: float) -> dict[str, float]:
    """Metrics around a Motion FID and a non-collision score."""
    fids = {"short": 0.8 * fid, "mid": fid, "long": 1.2 * fid, "average": fid}
    shares = {"30": share + 0.02, "45": share, "60": share - 0.02, "average": share}
    return {f"motion_fid/{k}": v for k, v in fids.items()} | {f"non_collision/{k}": v for k, v in shares.items()}


class Runs:
    """A folder of runs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def add(self, row: str, fid: float = 20.0, share: float = 0.9, **changes: dict) -> None:
        """A finished run; `data={"fps": 25}` and the like change one part."""
        content = copy.deepcopy(COMPLETE) | {"row": row, "components": components_of(row.partition("-")[0])}
        content["metrics"] = figures(fid, share)
        for name, value in changes.items():
            content[name] = {**content[name], **value} if isinstance(content.get(name), dict) else value
        self.write(row, "metrics.json", content)

    def add_truth(self, **changes: dict) -> None:
        self.add("ground_truth", 0.0, 0.995, method="GroundTruth", components=None, steps=0, **changes)
        path = self.folder / "ground_truth" / "metrics.json"
        content = json.loads(path.read_text())
        floor = {"short": 0.5, "mid": 0.7, "long": 0.9, "average": 0.7}
        content["metrics"] |= {f"motion_fid_floor/{name}": value for name, value in floor.items()}
        path.write_text(json.dumps(content))

    def fail(self, row: str, state: str = "failed", reason: str | None = "exit status 1: ValueError: no depth") -> None:
        self.write(row, "status.json", {"state": state, "reason": reason})

    def write(self, row: str, name: str, content: dict) -> None:
        (self.folder / row).mkdir(parents=True, exist_ok=True)
        (self.folder / row / name).write_text(json.dumps(content))


@pytest.fixture
def runs(tmp_path: Path) -> Runs:
    return Runs(tmp_path / "ablation")


@pytest.fixture
def whole(runs: Runs) -> Runs:
    """All 16 rows and the ground truth."""
    for place in range(16):
        letters = "".join(letter for bit, letter in enumerate("mdpc") if place >> bit & 1) or "none"
        runs.add(letters, fid=(20.0 if "m" in letters else 100.0) - place / 4, share=0.85 + place / 200)
    runs.add_truth()
    return runs
