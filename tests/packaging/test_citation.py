"""Version, authors and paper are the same wherever they are said."""

import re
import tomllib
from pathlib import Path

import yaml

from beliefnest.version import VERSION

TOP = Path(__file__).parents[2]
CITED = yaml.safe_load((TOP / "CITATION.cff").read_text(encoding="utf-8"))
README = (TOP / "README.md").read_text(encoding="utf-8")


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == CITED["version"] == VERSION
    assert project["license"] == CITED["license"]
    changes = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## {VERSION} - {CITED['date-released']}" in changes


def test_the_paper_is_cited_alike() -> None:
    (paper,) = CITED["references"]
    (bibtex,) = re.findall(r"```bibtex\n(.*?)```", README, re.DOTALL)
    fields = dict(re.findall(r"(\w+) += \{(.*?)\},?\n", bibtex))
    names = [f"{each['family-names']}, {each['given-names']}" for each in paper["authors"]]
    assert fields["title"] == paper["title"]
    assert fields["author"] == " and ".join(names)
    assert fields["year"] == str(paper["year"])
    assert fields["journal"].endswith(paper["identifiers"][0]["value"])
    assert f"]({paper['url']})" in README
