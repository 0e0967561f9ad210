"""The page about installing names what pyproject.toml asks for."""

import re
import tomllib
from pathlib import Path

TOP = Path(__file__).parents[2]
PAGE = (TOP / "docs" / "installation.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_every_extra_is_named() -> None:
    (table,) = re.findall(r"\n\| extra \|.*?\n\n", PAGE, re.DOTALL)
    first = [row.split("|")[1] for row in table.strip().splitlines()[2:]]
    named = {name for cell in first for name in re.findall(r"`(\w+)`", cell)}
    assert named == set(PROJECT["optional-dependencies"])


def test_every_dependency_is_weighed() -> None:
    (table,) = re.findall(r"\n\| package \|.*?\n\n", PAGE, re.DOTALL)
    for each in PROJECT["dependencies"]:
        assert re.search(rf"\b{re.escape(re.split('[<>=]', each)[0])}\b", table), each
