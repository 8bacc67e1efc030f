"""Packages: their versions beside what the project asks for, and whether they import."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from contextlib import suppress
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from sag.data.check.report import Line
from sag.doctor.probe import ITSELF
from sag.doctor.probed import Probed

DISTRIBUTION = "sag"

CONSTRAINTS = Path("constraints.txt")
"""Versions that were tested, in the clone."""

MODULES = {"pillow": "PIL", "pyyaml": "yaml", "lightning": "lightning.pytorch"}
"""Modules of packages whose names are others."""

UNASKED = ("torchvision",)
"""Packages that nothing here uses, and that torchmetrics imports wherever they are installed."""

REINSTALL = "make install, or pip install --constraint constraints.txt --editable ."


def required() -> dict[str, SpecifierSet]:
    """Packages that the project needs, with the versions that it asks for; none where it is not installed."""
    try:
        asked = [Requirement(line) for line in metadata.requires(DISTRIBUTION) or ()]
    except metadata.PackageNotFoundError:
        return {}
    return {each.name: each.specifier for each in asked if each.marker is None or each.marker.evaluate({"extra": ""})}


def modules(names: Mapping[str, SpecifierSet]) -> list[str]:
    """What is imported: the packages that are required, before them those that can break others by being there."""
    there = [name for name in UNASKED if find_spec(name)]
    return ["torch", *there, *(module_of(name) for name in names if name != "torch")]


def module_of(package: str) -> str:
    """What a package is imported as."""
    return MODULES.get(package, package.replace("-", "_"))


def package_lines(names: Mapping[str, SpecifierSet], probed: Probed) -> list[Line]:
    """Python, torch and Lightning with their versions, what is wrong with others, and what nobody asked for."""
    wrong = {name: line for name in names if (line := _wrong(name, names[name], probed))}
    first = [name for name in ("torch", "lightning") if name in names]
    told = [wrong[name] if name in wrong else Line(name, metadata.version(name), "ok") for name in first]
    others = [line for name, line in wrong.items() if name not in first]
    unasked = [_unasked(name, probed) for name in UNASKED]
    count = len(names) - len(told) - len(others)
    rest = Line("packages", f"{count} others, as asked for", "ok") if names else _not_installed()
    return [python_line(), *told[:1], *unasked, *told[1:], *others, rest, tested_line(), _itself(probed)]


def tested_line() -> Line:
    """Versions beside those that the tests were last green with, which others need not be worse than."""
    if not CONSTRAINTS.is_file():
        return Line("tested", f"{CONSTRAINTS} is not here, so what was tested is not known")
    pinned = dict(line.split("==") for line in CONSTRAINTS.read_text().splitlines() if "==" in line and line[0] != "#")
    others = []
    for name, version in pinned.items():
        with suppress(metadata.PackageNotFoundError):
            own = Version(metadata.version(name)).public
            others += [] if own == version else [f"{name} {own} here, {version} tested"]
    if not others:
        return Line("tested", f"every version is that of {CONSTRAINTS}", "ok")
    said = f"{len(others)} versions are others than in {CONSTRAINTS}"
    return Line("tested", said, "look", (*others, f"for those: {REINSTALL}"))


def python_line() -> Line:
    """The interpreter beside what the project asks for."""
    version = platform.python_version()
    try:
        asked = str(metadata.metadata(DISTRIBUTION)["Requires-Python"] or "")
    except metadata.PackageNotFoundError:
        asked = ""
    if SpecifierSet(asked).contains(version, prereleases=True):
        return Line("python", version, "ok")
    return Line("python", f"{version}, asked for is {asked}", "broken", ("make PYTHON=python3.11 with one that fits",))


def _wrong(name: str, asked: SpecifierSet, probed: Probed) -> Line | None:
    """What is wrong with a package, if anything."""
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        return Line(name, f"not installed, asked for is {asked or 'any version'}", "broken", (REINSTALL,))
    if not asked.contains(version, prereleases=True):
        return Line(name, f"{version}, asked for is {asked}", "broken", (REINSTALL,))
    error = probed.errors.get(module_of(name))
    if error is None:
        return None
    cause = next((f"by {other}, see there" for other in UNASKED if probed.errors.get(other) == error), None)
    ways = (cause,) if cause else (error, f"pip install --force-reinstall {name}")
    return Line(name, f"{version} does not import", "broken", ways)


def _not_installed() -> Line:
    return Line(
        "packages", "this program runs without being installed, so versions are not known", "look", (REINSTALL,)
    )


def _unasked(name: str, probed: Probed) -> Line:
    """A package that is better absent than broken."""
    error = probed.errors.get(name)
    if error:
        ways = (error, f"nothing here uses it, so: pip uninstall {name}", "or install the one made for this torch")
        return Line(name, "is installed and does not import, and torchmetrics imports it", "broken", ways)
    there = name in probed.found
    return Line(name, f"{probed.found[name]}, imports" if there else "not installed, and not needed", "ok")


def _itself(probed: Probed) -> Line:
    """Whether a run can start; the first that broke is named above."""
    error = probed.errors.get(ITSELF)
    if error:
        return Line("sag", "a run cannot start", "broken", (error,))
    if ITSELF not in probed.found:
        broke, why = next(iter(probed.errors.items()))
        return Line("sag", f"not tried: {broke} broke", "broken", (why,))
    return Line("sag", "all that a run needs imports", "ok")
