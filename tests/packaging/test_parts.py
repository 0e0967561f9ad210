"""Parts that rooms call from below are declared and can be loaded; a missing one is named."""

import tomllib
from pathlib import Path
from types import ModuleType

import pytest

from beliefnest.errors import InputError
from beliefnest.importing import part

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())
PARTS = PROJECT["project"]["entry-points"]["beliefnest.parts"]


@pytest.mark.parametrize("name", PARTS)
def test_a_declared_part_can_be_loaded(name):
    """A part is a function or a class; drawings and plots are modules of functions."""
    assert callable(part(name)) or isinstance(part(name), ModuleType)


def test_a_missing_part_is_named():
    with pytest.raises(InputError, match="no part 'roof'; install it again"):
        part("roof")


def test_no_contract_has_an_exception():
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    assert [each["name"] for each in contracts if "ignore_imports" in each] == []
