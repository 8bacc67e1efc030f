"""A sweep whose program is a small script: what it does is told by `plan.json` in the current folder."""

import json
import textwrap
from pathlib import Path

import pytest

import sag

PROGRAM = """
import json, os, signal, sys, time
from pathlib import Path

arguments = sys.argv[1:]
folder = Path(arguments[-1].partition("=")[2])
print("hello from", folder.name, flush=True)
wish = json.loads(Path("plan.json").read_text()).get(folder.name, {})
with open("calls.txt", "a") as calls:
    calls.write(json.dumps({"row": folder.name, "arguments": arguments, "environment": dict(os.environ)}) + "\\n")
if wish.get("stubborn"):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
(folder / "progress.json").write_text(json.dumps({"step": 3, "steps": 4, "stage": "fit"}))
(folder / "begun").touch()
time.sleep(wish.get("seconds", 0))
if wish.get("fails"):
    sys.exit("ValueError: " + wish["fails"])
if arguments[0] != "fit" and not wish.get("silent"):
    (folder / "metrics.json").write_text("{}")
"""

SWEEP = """
program: program.py
name: trial
method: grid
command: ["${env}", "${interpreter}", "${program}", run, --config, base.yaml, "${args}"]
parameters:
  components.separate: {values: [false, true]}
  components.context: {values: [false, true]}
"""


class Workplace:
    """A current folder with a sweep file, its program and the configs that it names."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.out = folder / "runs" / "trial"
        self.write("program.py", PROGRAM)
        self.write("sweep.yaml", SWEEP)
        self.write("base.yaml", "a: 1")
        self.write("configs/methods/erd.yaml", "method: erd")
        self.write("configs/methods/ground_truth.yaml", "method: ground_truth")
        self.write("configs/methods/blind.yaml", "method: blind")
        self.wishes()

    def write(self, name: str, text: str) -> str:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text))
        return name

    def wishes(self, **rows: dict) -> None:
        """What each row shall do: `seconds`, `fails`, `silent`, `stubborn`."""
        (self.folder / "plan.json").write_text(json.dumps(rows))

    def calls(self) -> list[dict]:
        path = self.folder / "calls.txt"
        return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []

    def names(self) -> list[str]:
        return [call["row"] for call in self.calls()]

    def forget(self) -> None:
        (self.folder / "calls.txt").unlink(missing_ok=True)

    def status(self, row: str) -> dict:
        return json.loads((self.out / row / "status.json").read_text())

    def states(self) -> dict[str, str]:
        return {path.parent.name: json.loads(path.read_text())["state"] for path in self.out.glob("*/status.json")}


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workplace:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(Path(sag.__file__).parents[1]))
    return Workplace(tmp_path)
