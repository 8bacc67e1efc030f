"""Other people's Fréchet distances, as they are published.

`make bench` puts those that `sag` does not need itself in a folder of their own, `peers` in the virtual environment,
so that nothing which was installed before changes and nobody else imports them. The image packages among them import
torchvision for networks of which nothing is used here. A torchvision that does not fit the installed torch cannot be
imported, and one that does may bring another torch along: where there is none, an empty stand-in takes its place while
the packages are imported. Their distances are their own code.
"""

from __future__ import annotations

import importlib
import io
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType

import torch
from torch import Tensor
from torchmetrics.image.fid import _compute_fid  # before the path grows: it looks for torch-fidelity when imported

Distance = Callable[[Tensor, Tensor, Tensor, Tensor], float]
"""Takes mean and covariance of two sets in float64."""

PUBLISHED = {
    "pytorch-fid": ("pytorch_fid.fid_score", "calculate_frechet_distance"),
    "clean-fid": ("cleanfid.fid", "frechet_distance"),
}
"""Where packages that work on numpy arrays have their distance."""

BESIDE = ("torch", "torchmetrics", "numpy", "scipy")
"""Packages whose versions decide a time too."""


def frechet_peers() -> dict[str, Distance]:
    """The distances of those peers that are installed."""
    found: dict[str, Distance] = {"torchmetrics": lambda *moments: float(_compute_fid(*moments))}
    folder = str(Path(sys.prefix) / "peers")
    if folder not in sys.path:
        sys.path.append(folder)
    for package, (module, function) in PUBLISHED.items():
        try:
            with _torchvision_or_stand_in():
                found[package] = _of_arrays(getattr(importlib.import_module(module), function))
        except ModuleNotFoundError as error:
            if error.name != module.partition(".")[0]:
                raise
    return found


def versions() -> dict[str, str]:
    """Versions of the peers and of what they stand on; "missing" where a peer is not installed."""
    return {package: _version(package) for package in (*PUBLISHED, *BESIDE)}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "missing"


def _of_arrays(distance: Callable[..., float]) -> Distance:
    """A distance of numpy arrays without what it says of singular products and of scipy's future."""

    def quiet(*moments: Tensor) -> float:
        with warnings.catch_warnings(), redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            return float(distance(*(x.numpy() for x in moments)))

    return quiet


class _StandIn(ModuleType):
    """A module in which every class is an empty network and every other name a module like it."""

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return torch.nn.Module if name[0].isupper() else _StandIn(f"{self.__name__}.{name}")


@contextmanager
def _torchvision_or_stand_in() -> Iterator[None]:
    """Lets `import torchvision` succeed."""
    try:
        importlib.import_module("torchvision")
    except Exception:  # beside another torch it fails by whatever it meets first
        names = ("torchvision", "torchvision.transforms")
        sys.modules.update({name: _StandIn(name) for name in names})
        try:
            yield
        finally:
            for name in names:
                del sys.modules[name]
    else:
        yield
