"""`sag doctor` names what is wrong with a machine, survives it, and says what to do."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from doctor_findings import working
from packaging.specifiers import SpecifierSet
from rich.console import Console

from sag.cli import main
from sag.data.check.report import Line, Report, Section, show
from sag.doctor import command_line, machine, packages
from sag.doctor.probed import Probed, probed

ROOT = Path(__file__).parents[2]


def package(folder: Path, name: str, code: str) -> None:
    """A package as pip leaves it, with its metadata."""
    (folder / name).mkdir()
    (folder / name / "__init__.py").write_text(code)
    (folder / f"{name}-9.9.dist-info").mkdir()
    (folder / f"{name}-9.9.dist-info/METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 9.9\n")


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder from which the process that is tried imports first."""
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")
    return tmp_path


def test_this_machine_is_examined(tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    status = main(["doctor", "--json", "--runs", str(tmp_path / "runs"), "--data", str(tmp_path / "data")])
    found = json.loads(capsys.readouterr().out)
    assert status == (1 if found["stops"] else 0)
    lines = {line["name"]: line for lines in found["sections"].values() for line in lines}
    assert {"python", "torch", "lightning", "torchvision", "sag", "cpu", "data", "runs", "W&B", "SLURM"} <= lines.keys()
    assert [lines[name]["verdict"] for name in ("torch", "sag", "cpu", "data", "runs")] == ["ok"] * 5
    assert lines["torch"]["value"] == metadata.version("torch")
    assert list(tmp_path.iterdir()) == []


def test_a_torchvision_that_breaks_imports_is_named(path: Path) -> None:
    package(path, "torchvision", "raise RuntimeError('operator torchvision::nms does not exist')")
    tried = probed(["torchvision"])
    line = packages._unasked("torchvision", tried)
    assert line.verdict == "broken" and "nms does not exist" in line.details[0]
    assert "pip uninstall torchvision" in line.details[1]
    assert "sag.training" in {*tried.errors, *tried.found} and "devices" in tried.found
    tried.errors["torchmetrics"] = tried.errors["torchvision"]
    lines = packages.package_lines({"torch": SpecifierSet(), "torchmetrics": SpecifierSet()}, tried)
    assert [line.name for line in lines if line.verdict == "broken"][:2] == ["torchvision", "torchmetrics"]
    assert lines[3].details == ("by torchvision, see there",)


def test_a_package_that_ends_the_process_is_named(path: Path) -> None:
    (path / "crashes.py").write_text("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    (path / "fine.py").write_text("__version__ = '1'; print('chatter')")
    tried = probed(["fine", "crashes", "later"])
    assert tried == Probed({"fine": "1"}, {"crashes": "it ended the process by SIGSEGV"})
    line = packages._itself(tried)
    assert (line.verdict, line.value) == ("broken", "not tried: crashes broke")
    assert machine.device_lines(tried)[0].verdict == "broken"


def test_an_import_that_hangs_is_named(path: Path) -> None:
    (path / "hangs.py").write_text("import time; time.sleep(60)")
    assert probed(["hangs"], patience=2).errors == {"hangs": "it had not ended after 2 s"}


def test_an_interpreter_that_does_not_start_is_named() -> None:
    (error,) = probed([], python="/no/python").errors.values()
    assert "/no/python cannot be started" in error


VERSIONS: dict[str, tuple[str, str, str]] = {
    "too old": ("numpy", ">=99", "asked for is >=99"),
    "missing": ("no-such-package", ">=1", "not installed"),
}


@pytest.mark.parametrize("case", VERSIONS)
def test_a_version_that_does_not_fit_is_named(case: str) -> None:
    name, asked, said = VERSIONS[case]
    lines = packages.package_lines({"torch": SpecifierSet(""), name: SpecifierSet(asked)}, working())
    (line,) = (line for line in lines if line.name == name)
    assert line.verdict == "broken" and said in line.value and "constraints.txt" in line.details[0]


def test_a_package_that_does_not_import_is_named() -> None:
    tried = Probed({}, {"numpy": "ImportError: no libopenblas", "sag.training": "ImportError: no libopenblas"})
    lines = {line.name: line for line in packages.package_lines({"numpy": SpecifierSet(">=1")}, tried)}
    assert lines["numpy"].verdict == lines["sag"].verdict == "broken"
    assert lines["numpy"].details == ("ImportError: no libopenblas", "pip install --force-reinstall numpy")


def test_what_the_project_needs_is_read_from_the_project() -> None:
    assert {"torch", "lightning", "wandb", "kornia"} <= packages.required().keys()
    assert not {"pytest", "smplx", "clean-fid"} & packages.required().keys()
    assert packages.modules({"pillow": SpecifierSet(), "pyyaml": SpecifierSet()})[-2:] == ["PIL", "yaml"]


def test_versions_beside_the_tested_ones(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert packages.tested_line().verdict == ""
    Path("constraints.txt").write_text(f"# tested\nnumpy==0.1\nnot-here==1\ntorch=={metadata.version('torch')}\n")
    line = packages.tested_line()
    assert line.verdict == "look" and line.details[0] == f"numpy {metadata.version('numpy')} here, 0.1 tested"


def test_the_status_says_what_would_stop_the_ablation(monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    endings = (("ok", 0, "yes"), ("look", 0, "yes; worth a look: thing"), ("broken", 1, "BROKEN: thing"))
    for verdict, status, ending in endings:
        report = Report("Ready?", (Section("One", (Line("thing", "as it is", verdict, ("do this",)),)),), good="yes")
        monkeypatch.setattr(command_line, "examined", lambda data, runs, report=report: report)
        assert command_line.main([]) == status
        said = capsys.readouterr().out
        assert "do this" in said and said.rstrip().endswith(ending)
        assert command_line.main(["--json"]) == status
        assert json.loads(capsys.readouterr().out)["stops"] == (["thing"] if status else [])


def test_the_doctor_loads_nothing_that_may_be_broken() -> None:
    code = "import sys, sag.doctor.command_line; print({'torch', 'numpy', 'lightning', 'wandb'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_it_fits_a_narrow_terminal() -> None:
    report = Report("Ready?", (Section("One", (Line("thing", "long " * 40, "look", ("do " * 60,)),)),))
    console = Console(width=60, file=io.StringIO())
    show(report, console)
    lines = console.file.getvalue().splitlines()
    assert len(lines) > 5 and max(map(len, lines)) <= 60
