"""A supplement holds the packages of prompt filters, in a form in which Python finds them."""

import subprocess
import sys

import pytest
from tests.installing import install

from beliefnest.studies.filter_packages import filter_packages

SOURCE = """
from beliefnest.prompts import filter
from shouting_here.words import loud

@filter("shouting")
def shouting(branch):
    return loud(branch.state.owner)
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    package = tmp_path / "site" / "shouting_here"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("", encoding="utf-8")
    (package / "words.py").write_text("loud = str.upper\n", encoding="utf-8")
    (package / "filters.py").write_text(SOURCE, encoding="utf-8")
    declared = "[beliefnest.filters]\nshouting = shouting_here.filters:shouting\n"
    install(package.parent, "shouting-here", declared)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))


@pytest.mark.usefixtures("installed")
def test_the_packages_can_be_used_from_the_supplement(tmp_path, monkeypatch):
    files = filter_packages()
    assert "packages/shouting_here/words.py" in files
    for name, content in files.items():
        path = tmp_path / "supplement" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "supplement" / "packages"))
    program = (
        "from beliefnest.prompts.builtin import BUILT_IN\n"
        "from beliefnest.prompts.filterset import installed_filters\n"
        "print('shouting' in installed_filters(BUILT_IN).filters)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "True"


def test_without_filters_a_supplement_has_no_packages():
    assert filter_packages() == {}
