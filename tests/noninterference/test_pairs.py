"""Pairs of worlds that differ only behind a wall do differ."""

from tests.noninterference.pairs import pair_of, played


def test_pairs_differ_in_reality() -> None:
    different = 0
    for seed in range(20):
        texts = []
        for which in (0, 1):
            with played(pair_of(seed), which) as world:
                texts.append(world.nest["/"].render("{{ branch | beginning }}{{ branch | story }}"))
        different += texts[0] != texts[1]
    assert different >= 18
