"""Makes one sentence of what the option parser complains about."""

from __future__ import annotations

import dataclasses
import difflib
import importlib
import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager

from jsonargparse import ArgumentError

from sag.errors import SagError

UNION = re.compile(
    r"Problem with given class_path '([^']+)': (.*?)(?: - Expected a <class 'NoneType'>| - Problem with|$)"
)
"""The heart of a complaint about an option that may be a class or nothing."""


def one_sentence(message: str) -> str:
    """The heart of a parser's message, with the nearest name where one was mistyped.

    Args:
        message: what the parser said, over as many lines as it liked.
    """
    text = re.sub(r"\s+", " ", message).strip()
    key = re.match(r'Parser key "([^"]+)": ', text)
    place = f"--{key.group(1)}" if key else ""
    union = UNION.search(text)
    heart = union.group(2) if union else text[key.end() :] if key else text
    inner = re.match(r'Parser key "([^"]+)": ', heart)
    if inner:
        place, heart = f"{place}.{inner.group(1)}", heart[inner.end() :]
    heart = heart.split(" Given value type")[0].split(" Subtypes:")[0]
    sentence = f"{place}: {heart}" if place else heart
    return sentence.strip() + _nearest(heart, union.group(1) if union else None)


LINKS = ("skeleton", "image_size")
"""What every method takes from the data, where it takes it at all."""


@contextmanager
def one_sentence_each(about: str = "") -> Iterator[None]:
    """Makes one sentence of whatever is wrong with options and configs that are parsed inside.

    Args:
        about: what stands before what the parser says.

    Raises:
        SagError: an option is unknown or wrong, or a class refuses its options, which the parser hides behind the
            types that it tried.
    """
    try:
        yield
    except ArgumentError as error:
        raise SagError(about + one_sentence(str(error))) from error
    except ValueError as error:
        raise _refusal(error) or error from None


def _refusal(error: BaseException | None) -> SagError | None:
    while error is not None and not isinstance(error, SagError):
        error = error.__cause__ or error.__context__
    return error


def _nearest(heart: str, class_path: str | None) -> str:
    typed = re.search(r"(?:Option '|--|Key ')([\w.]+)", heart)
    if typed is None or class_path is None:
        return ""
    words = typed.group(1).split(".")
    names = _names(class_path)
    wrong = next((w for w in words if w not in names), words[-1])
    close = difflib.get_close_matches(wrong, names, 1)
    return f"; did you mean {close[0]!r}?" if close else f"; known are {', '.join(sorted(names))}"


def _names(class_path: str) -> set[str]:
    """Options of a class, and those of the dataclasses among them."""
    module, _, name = class_path.rpartition(".")
    parameters = inspect.signature(getattr(importlib.import_module(module), name), eval_str=True).parameters
    names = set(parameters)
    for parameter in parameters.values():
        if dataclasses.is_dataclass(parameter.annotation):
            names |= {field.name for field in dataclasses.fields(parameter.annotation)}
    return names
