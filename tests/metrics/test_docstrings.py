"""The examples in the docstrings run and print what they say."""

import doctest
import importlib
import pkgutil

import pytest

import sag.geometry
import sag.metrics

MODULES = [f"{p.__name__}.{m.name}" for p in (sag.metrics, sag.geometry) for m in pkgutil.iter_modules(p.__path__)]


def test_every_public_metric_has_an_example():
    for name in sag.metrics.__all__:
        assert ">>>" in getattr(sag.metrics, name).__doc__, name


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    assert doctest.testmod(importlib.import_module(name)).failed == 0
