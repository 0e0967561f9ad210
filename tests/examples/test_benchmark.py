"""The example of a set of items: seven families, orders 0 to 4, every shortcut at chance."""

from collections import Counter
from pathlib import Path

import pytest
import yaml
from tests.profiles import NIGHTLY

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
@pytest.mark.skipif(not NIGHTLY, reason="it plays 350 scenes, at night")
def test_every_shortcut_is_at_chance_on_the_whole_set() -> None:
    made = bn.Study.load(STUDY).items(name="who-saw-it")
    assert len(made.items) >= 1000
    assert made.dropped == ()
    check_items(made.items, families=7)
    rows = {row["shortcut"]: row for row in shortcut_rows(made.items)}
    for name in yaml.safe_load(STUDY.read_text(encoding="utf-8"))["balance"]:
        assert rows[name]["accuracy"] == pytest.approx(1 / 3, abs=0.005)
    # Another version of the solver may choose other scenes, on which one of the rest can be lucky.
    assert [row for row in rows.values() if abs(row["accuracy"] - 1 / 3) > 0.05] == []
