"""The letters of the ablation (paper, Table 1): one for each component that can be switched on.

A component is a boolean field of `Components`; its letter names it in row names and in tables.
"""

from __future__ import annotations

from collections.abc import Mapping

LETTERS: dict[str, str] = {"separate": "M", "depth": "D", "projection": "P", "context": "C"}
"""Component to letter, in the order in which the paper writes them."""


def row_name(components: Mapping[str, bool]) -> str:
    """The name of the row with these components: `none`, `m`, `md`, ..., `mdpc`, always in the order of `LETTERS`."""
    return "".join(letter.lower() for name, letter in LETTERS.items() if components.get(name)) or "none"


def components_of(row: str) -> dict[str, bool] | None:
    """The components that a row name stands for, or None where it is not made of letters."""
    components = {name: letter.lower() in row for name, letter in LETTERS.items()}
    return components if row_name(components) == row else None
