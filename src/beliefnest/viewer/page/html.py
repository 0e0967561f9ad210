"""Page as one HTML text, with program, style and data inlined; it fetches nothing."""

import base64
import hashlib
import html
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from beliefnest.errors import InputError
from beliefnest.world.texts import on_one_line, visible_json

_BUILT = Path(__file__).parents[2] / "_page"

_SHELL = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="referrer" content="no-referrer">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{style}</style>
</head>
<body{body}>
<div id="page"></div>
<script type="application/json" id="data">{data}</script>
<script>{program}</script>
</body>
</html>
"""


def page_html(title: str, content: Mapping[str, Any], *, served: bool, name: str = "page") -> str:
    """Return the page.

    Args:
        title: Title of the browser's tab.
        content: Data of the page; it is compressed with deflate and encoded as base64.
        served: True if the page communicates with the server that sent it.
        name: Name of its program.

    Raises:
        InputError: The page was not built with the package.
    """
    style, program = _part("page.css"), _part(f"{name}.js")
    return self_contained(
        title,
        style,
        program,
        {"served": served, "packed": packed(content)},
        connect="'self'" if served else "'none'",
        pictures="data: blob:",
    )


def self_contained(
    title: str,
    style: str,
    program: str,
    data: object,
    *,
    connect: str,
    pictures: str,
    body_class: str | None = None,
) -> str:
    """Return a page with style, program and data inlined, which may run nothing else.

    Args:
        title: Title of the browser's tab.
        style: Style sheet, as `inlined` returns texts.
        program: JavaScript, as `inlined` returns texts.
        data: JSON data for the program, in which texts of others are `packed`.
        connect: Addresses that the page may talk to, as in a content security policy.
        pictures: Sources of its pictures, in the same form.
        body_class: Class of the body; None: no class.
    """
    policy = (
        f"default-src 'none'; script-src {_source_hash(program)}; style-src {_source_hash(style)}; "
        f"img-src {pictures}; connect-src {connect}; base-uri 'none'; form-action 'none'"
    )
    return _SHELL.format(
        policy=html.escape(policy),
        title=html.escape(on_one_line(title)),
        style=style,
        body="" if body_class is None else f' class="{body_class}"',
        # Base64 has no `<`, so that nothing in the data can end the element.
        data=json.dumps(data),
        program=program,
    )


def packed(content: Mapping[str, Any]) -> str:
    """Return data of a page as JSON, compressed with deflate and encoded as base64."""
    text = visible_json(json.dumps(content, separators=(",", ":"), ensure_ascii=False))
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


def _source_hash(text: str) -> str:
    """Return the source of a content security policy that allows an inlined text."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _part(name: str) -> str:
    file = _BUILT / name
    if not file.is_file():
        raise InputError(f"the page is missing at {file}: run `pip install .` to build it")
    return inlined(file.read_text(encoding="utf-8"))


def inlined(text: str) -> str:
    """Return a program for a `<script>` element; nothing in its strings ends the element."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
