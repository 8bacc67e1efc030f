"""What machines do to runs, on purpose: kills a sweep at random moments, flips bits, cuts files, fills disks.

`make chaos` runs the long form and prints the counts; `tests/test_chaos.py` runs a short one.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent

SWEEP = """
program: sag
name: chaos
method: grid
command: ["${env}", "${interpreter}", -m, sag, run, --config, configs/base.yaml, --config, TINY, "${args}"]
parameters:
  config:
    values: [ROWS]
"""

TINY = """
model: {init_args: {network: {width: 0.05, critic_norm: layer}, average: 0.9}}
encoder_width: 0.05
data:
  class_path: toy_data.ToyDataModule
  init_args: {cache_dir: CACHE, image_size: [36, 64], batch_size: 2}
trainer:
  max_epochs: EPOCHS
  accelerator: cpu
  enable_progress_bar: false
  save_every_n_batches: 3
"""


class TinySweep:
    """A sweep of toy runs in a folder of its own, run as a user runs it.

    Args:
        folder: gets the sweep file, the data's cache and the rows.
        rows: configs of the rows, by the stem of their file.
        epochs: of each row, of four batches each.
        jobs: rows at a time.
    """

    def __init__(self, folder: Path, rows: tuple[str, ...], epochs: int, jobs: int = 2) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.out, self.jobs = folder, folder / "rows", jobs
        configs = ", ".join(f"configs/ablations/{row}.yaml" for row in rows)
        text = TINY.replace("CACHE", str(folder / "cache")).replace("EPOCHS", str(epochs))
        (folder / "tiny.yaml").write_text(text)
        (folder / "sweep.yaml").write_text(SWEEP.replace("ROWS", configs).replace("TINY", str(folder / "tiny.yaml")))

    def start(self, *options: str) -> subprocess.Popen[bytes]:
        """The sweep in a process of its own, which leads a group.

        Args:
            options: further ones of `sag sweep`.
        """
        command = [sys.executable, "-m", "sag", "sweep", str(self.folder / "sweep.yaml"), "--out", str(self.out)]
        environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}", "WANDB_MODE": "offline"}
        with (self.folder / "sweep.log").open("ab") as log:
            return subprocess.Popen(
                [*command, "--jobs", str(self.jobs), *options],
                stdout=log,
                stderr=subprocess.STDOUT,
                env=environment,
                cwd=ROOT,
                start_new_session=True,
            )

    def running(self) -> dict[str, int]:
        """Process of each row that runs, by the row's name."""
        found = {}
        for path in self.out.glob("*/status.json"):
            status = json.loads(path.read_text())
            if status["state"] == "running":
                found[path.parent.name] = status["pid"]
        return found

    def log(self) -> str:
        """What the sweep has said so far."""
        return (self.folder / "sweep.log").read_text()

    def figures(self) -> dict[str, Any]:
        """Every row's figures and what is known of them, without times."""
        found = {}
        for path in sorted(self.out.glob("*/metrics.json")):
            found[path.parent.name] = {k: v for k, v in json.loads(path.read_text()).items() if k != "seconds"}
        return found

    def tables(self) -> dict[str, bytes]:
        """The final table in every format, of the rows as if they had taken no time."""
        rows = self.folder / "timeless"
        for name, figures in self.figures().items():
            (rows / name).mkdir(parents=True, exist_ok=True)
            (rows / name / "metrics.json").write_text(json.dumps({**figures, "seconds": {}}))
            status = json.loads((self.out / name / "status.json").read_text())
            timeless = {**status, **dict.fromkeys(("started", "ended", "heartbeat", "pid"))}
            (rows / name / "status.json").write_text(json.dumps(timeless))
        report = [sys.executable, "-m", "sag", "report", str(rows), "--out", str(self.folder / "report")]
        subprocess.run(report, check=True, stdout=subprocess.DEVNULL, cwd=ROOT)
        return {path.name: path.read_bytes() for path in (self.folder / "report").glob("table.*")}

    def strays(self) -> list[Path]:
        """Temporary files that nobody will rename any more."""
        return [path for path in self.folder.rglob(".*") if path.suffix[1:].isdecimal()]

    def unreadable(self) -> list[Path]:
        """Checkpoints that are not as they were written."""
        from sag.errors import Damaged
        from sag.seal import read_sealed

        found = []
        for path in self.out.rglob("*.ckpt"):
            try:
                read_sealed(path)
            except Damaged:
                found.append(path)
        return found


def disturbed(sweep: TinySweep, signals: list[signal.Signals], chance: random.Random, longest: float) -> Counter[str]:
    """Runs a sweep to its end, sending it or one of its rows a signal after random times until all are sent.

    Returns:
        How often what was hit, and how often a row went on from a checkpoint.
    """
    counts: Counter[str] = Counter()
    process = sweep.start()
    while True:
        with suppress(subprocess.TimeoutExpired):
            process.wait(chance.uniform(2, longest) if signals else None)
        if process.poll() is not None:
            if process.returncode == 0:
                break
            process = sweep.start()
        elif signals:
            counts[_hit(sweep, process, signals.pop(), chance)] += 1
    counts["rows that went on"] = sum(
        path.read_text().count("training goes on from") for path in sweep.out.glob("*/log.txt")
    )
    return counts


def _hit(sweep: TinySweep, process: subprocess.Popen[bytes], sent: signal.Signals, chance: random.Random) -> str:
    """Sends a signal to the sweep or to one of the rows that run."""
    rows = sorted(sweep.running().items())
    if rows and chance.random() < 0.6:
        _, pid = chance.choice(rows)
        with suppress(ProcessLookupError):
            os.killpg(pid, sent)
        return f"{sent.name} to a row"
    process.send_signal(sent)
    began = time.monotonic()
    process.wait(30)
    if sent == signal.SIGTERM and time.monotonic() - began > 15:
        raise AssertionError("a sweep took more than its 10 s and a moment to end")
    return f"{sent.name} to the sweep"


def main() -> int:
    """Runs the long form and prints the counts; 1 when anything was lost."""
    parser = argparse.ArgumentParser(prog="make chaos", description=__doc__)
    parser.add_argument("--kills", type=int, default=50, help="kill -9 of the sweep or a row")
    parser.add_argument("--terms", type=int, default=10, help="SIGTERM to the sweep or a row")
    parser.add_argument("--rows", default="none,m,md,mdp,mdc,mdpc", help="rows of the sweep")
    parser.add_argument("--epochs", type=int, default=30, help="epochs of each row")
    parser.add_argument("--longest", type=float, default=40, help="seconds between two signals, at most")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    asked = parser.parse_args()
    chance = random.Random(asked.seed)
    signals = [signal.SIGKILL] * asked.kills + [signal.SIGTERM] * asked.terms
    chance.shuffle(signals)
    with tempfile.TemporaryDirectory(prefix="sag-chaos-") as place:
        return _compare(Path(place), asked, signals, chance)


def _compare(place: Path, asked: argparse.Namespace, signals: list[signal.Signals], chance: random.Random) -> int:
    """The undisturbed sweep, then disturbed ones until every signal has been sent."""
    rows = tuple(asked.rows.split(","))
    whole = TinySweep(place / "undisturbed", rows, asked.epochs)
    if whole.start().wait():
        print(whole.log())
        return 1
    counts: Counter[str] = Counter()
    wrong = 0
    while signals:
        sweep = TinySweep(place / f"disturbed-{counts['sweeps']}", rows, asked.epochs)
        counts += disturbed(sweep, signals, chance, asked.longest)
        counts["sweeps"] += 1
        same = sweep.tables() == whole.tables() and sweep.figures() == whole.figures()
        strays, unreadable = sweep.strays(), sweep.unreadable()
        wrong += (not same) + len(strays) + len(unreadable)
        print(
            f"sweep {counts['sweeps']}: table identical {same}, stray files {strays}, unreadable {unreadable}",
            flush=True,
        )
    print("\n".join(f"{count:5} {what}" for what, count in sorted(counts.items())))
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
