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


def our_figures(fid: float) -> dict[str, float]:
    """Every further figure that a test writes, in its own unit, with some that depend on the row."""
    steps = ("0.5", "1", "1.5", "2")
    return {
        "motion_fid_interval/low": 0.9 * fid, "motion_fid_interval/high": 1.2 * fid,
        "motion_fid_infinity/average": 0.95 * fid, "motion_kid/average": fid / 100,
        "velocity_frechet": 2 * fid, "scene_frechet": 3 * fid,
        "collisions/matched": 0.06, "collisions/elsewhere": 0.12, "collisions/ratio": 0.5,
        "penetration/share": fid / 1000, "penetration/root": 0.05, "penetration/depth": 0.0123,
        "floor/sunk": 0.01, "floor/floating": 0.02, "floor/error": 0.03,
        "depth_error/abs_rel": 0.2, "depth_error/rmse": 0.7, "depth_error/delta1": 0.6,
        "depth_probe/rmse": 0.3, "depth_probe/explained": 0.4,
        "foot_skate": 0.8, "foot_contact": 0.5, "bone_drift": 0.15, "acceleration": 6.0, "jerk": 2400.0,
        "diversity/deviation": 0.3, "diversity/pairwise": 0.5, "diversity/multimodality": 2.0,
        **{f"best_of/path_{time}": 0.4 for time in steps}, **{f"best_of/pose_{time}": 0.1 for time in steps},
    }  # fmt: skip


OUR_FLOORS = {"velocity_frechet_floor": 0.6, "scene_frechet_floor": 1.4}


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

    def measure_more(self) -> None:
        """Gives every row of the folder our figures too."""
        for path in self.folder.glob("*/metrics.json"):
            content = json.loads(path.read_text())
            ours = our_figures(content["metrics"]["motion_fid/average"])
            content["metrics"] |= ours | (OUR_FLOORS if path.parent.name == "ground_truth" else {})
            path.write_text(json.dumps(content))

    def add_blind(self, fid: float = 21.0, share: float = 0.8, name: str = "blind", **changes: dict) -> None:
        self.add(name, fid, share, components=components_of("m"), **changes)

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
