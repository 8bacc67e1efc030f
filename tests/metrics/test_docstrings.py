"""The examples in the docstrings run and print what they say."""

import doctest
import importlib
import pkgutil

import pytest

import sag.geometry
import sag.metrics

MODULES = [
    module.name
    for package in (sag.metrics, sag.geometry)
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
]


def test_every_public_metric_has_an_example():
    for name in sag.metrics.__all__:
        assert ">>>" in getattr(sag.metrics, name).__doc__, name


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    assert doctest.testmod(importlib.import_module(name)).failed == 0
