"""Nothing that is said or shown for an agent differs in worlds that are the same to the agent.

The words of `methods` and of the reports of runs and studies have no door: they name settings and
count rows, and say nothing of a belief.
"""

import pytest
import tests.noninterference.acting_doors
import tests.noninterference.asked_doors
import tests.noninterference.environment_doors
import tests.noninterference.page_doors
import tests.noninterference.prose_doors
import tests.noninterference.shown_doors
import tests.noninterference.spaces_doors  # noqa: F401 - these modules register doors
from tests.noninterference.doors import DOORS, Door
from tests.noninterference.pairs import PATHS, Played, pair_of, played
from tests.profiles import NIGHTLY, at_night, few_by_day

PAIRS, PARTS, BY_DAY = at_night(5000, 200), 10, 6


def chosen(seed: int) -> tuple[list[Door], tuple[str, ...]]:
    """Return the doors and paths of a pair: at night all paths; by day one, and fewer doors."""
    turn = seed // PARTS + seed % PARTS
    paths = PATHS if NIGHTLY else (PATHS[(turn // 3) % len(PATHS)],)
    times = 1 if NIGHTLY else 3
    numbered = enumerate(DOORS.values())
    return [door for n, door in numbered if (turn + n) % (times * door.every) == 0], paths


def looks(world: Played, seed: int) -> dict[tuple[str, str], str]:
    """Return what doors show of paths, path by path: what was read of one is kept until then."""
    doors, paths = chosen(seed)
    return {(each.name, path): repr(each.look(world, path)) for path in paths for each in doors}


@pytest.mark.parametrize("part", few_by_day(range(PARTS), BY_DAY))
def test_nothing_differs(part: int) -> None:
    for seed in range(part, PAIRS, PARTS):
        pair = pair_of(seed)
        with played(pair, 0) as world:
            one = looks(world, seed)
        with played(pair, 1) as world:
            other = looks(world, seed)
        for key, shown in one.items():
            assert shown == other[key], f"pair {seed}, {key[0]} of {key[1]}"


def test_every_door_is_gone_through_by_day() -> None:
    seeds = [seed for seed in range(200) if seed % PARTS < BY_DAY]
    gone = {(door.name, path) for seed in seeds for door in chosen(seed)[0] for path in PATHS}
    assert {name for name, _ in gone} == set(DOORS)


def test_pairs_differ_in_reality() -> None:
    different = 0
    for seed in range(20):
        texts = []
        for which in (0, 1):
            with played(pair_of(seed), which) as world:
                texts.append(world.nest["/"].render("{{ branch | beginning }}{{ branch | story }}"))
        different += texts[0] != texts[1]
    assert different >= 18
