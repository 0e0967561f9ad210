"""The example of a set of items: seven families, orders 0 to 4, every shortcut at chance."""

import shutil
from collections import Counter
from pathlib import Path

import pytest
from tests.profiles import NIGHTLY, at_night

import beliefnest as bn
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.items.report import shortcut_rows

STUDY = Path(__file__).parents[2] / "examples" / "benchmark" / "study.yaml"


def check_items(items: tuple[ItemRecord, ...], *, families: int) -> None:
    assert {each.checked for each in items} == {"follows"}
    assert len({each.family for each in items}) == families
    orders = Counter(each.order for each in items)
    assert sorted(orders) == [0, 1, 2, 3, 4]
    assert len(set(orders.values())) == 1


@pytest.mark.parametrize("family", sorted(each.stem for each in STUDY.parent.glob("*-*.yaml")))
def test_a_family_has_items_of_each_order(family: str) -> None:
    made = bn.Study([str(STUDY.with_name(f"{family}.yaml"))], variations=1).items()
    assert made.dropped == ()
    check_items(made.items, families=1)


@pytest.mark.long
@pytest.mark.extra("scipy")
def test_every_shortcut_is_at_chance_on_the_whole_set(tmp_path: Path) -> None:
    folder = shutil.copytree(STUDY.parent, tmp_path / "benchmark")
    file = folder / STUDY.name
    few = STUDY.read_text(encoding="utf-8").replace("variations: 48", "variations: 9")
    file.write_text(STUDY.read_text(encoding="utf-8") if NIGHTLY else few, encoding="utf-8")
    made = bn.Study.load(file).items(name="who-saw-it")
    assert len(made.items) >= at_night(1000, 80)
    assert made.dropped == ()
    check_items(made.items, families=7)
    rows = {row["shortcut"]: row for row in shortcut_rows(made.items)}
    for name in ("reality", "lower_order", "first", "last", "most"):
        assert rows[name]["accuracy"] == pytest.approx(1 / 3)
    # Another version of the solver may choose other scenes, on which one of the rest can be lucky,
    # as each can where there are few.
    far = {name for name, row in rows.items() if abs(row["accuracy"] - 1 / 3) > 0.05}
    assert not (NIGHTLY and far)
