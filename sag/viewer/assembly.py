"""Pages of one file: style, scripts and data put into a template, under a policy that forbids all else."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from string import Template

ASSETS = "sag.viewer"
"""Package whose folder `assets` has the drawing that pages share."""

DRAWING = ("data", "vectors", "shapes", "surface", "shaders", "drawing", "renderer", "orbit", "picture", "stage")
"""Modules of the script that every page needs to show motions in their scene, in the order in which they are joined."""


def asset(name: str, package: str = ASSETS) -> str:
    """A file of a package's folder `assets`."""
    return (files(package) / "assets" / name).read_text(encoding="utf-8")


def script_of(names: Sequence[str], package: str = ASSETS) -> str:
    """Modules of a script one after the other, the drawing before them."""
    modules = [asset(f"{name}.js") for name in DRAWING] + [asset(f"{name}.js", package) for name in names]
    return "\n".join(["'use strict';", *modules])


def assembled(template: str, style: str, script: str, title: str, connect: str = "'none'", **texts: str) -> str:
    """A page that loads nothing, and asks for nothing from anywhere else.

    Args:
        template: of the page, with a `$name` for every text.
        style: of the page.
        script: of the page.
        title: of the page, as plain text.
        connect: what the script may talk to, as a policy says it.
        texts: further texts, as HTML.
    """
    policy = (
        f"default-src 'none'; script-src {_digest(script)}; style-src {_digest(style)}; img-src data:; "
        f"connect-src {connect}; base-uri 'none'; form-action 'none'"
    )
    filled = {"policy": policy, "title": escape(title), "style": style, "script": script, **texts}
    return Template(template).substitute(filled)


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
