"""Parquet of a set of items."""

import json

import pytest
from tests.studies.items.test_items import SCENARIO, STUDY

import beliefnest as bn
from beliefnest.studies.items.parquet import parquet_differences, write_parquet_of


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("made")
    (place / "boxes.yaml").write_text(SCENARIO, encoding="utf-8")
    (place / "study.yaml").write_text(STUDY, encoding="utf-8")
    return bn.Study.load(place / "study.yaml").items(name="boxes")


@pytest.fixture
def folder(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made.write("set")
    return tmp_path


@pytest.mark.extra("pyarrow")
def test_parquet_holds_the_items(folder, made):
    from pyarrow import parquet

    place = folder / "set"
    write_parquet_of(made, place)
    read = parquet.read_table(place / "items.parquet").to_pylist()
    assert [(each["id"], each["options"]) for each in read] == [
        (each.id, list(each.options)) for each in made.items
    ]
    assert json.loads(read[0]["factors"]) == dict(made.items[0].factors)
    assert parquet_differences(made, place) == made.differences(place) == []
    parquet.write_table(parquet.read_table(place / "items.parquet")[1:], place / "items.parquet")
    assert parquet_differences(made, place) == ["items.parquet: holds other items"]
    (place / "items.parquet").write_bytes(b"broken")
    assert parquet_differences(made, place) == ["items.parquet: holds other items"]
