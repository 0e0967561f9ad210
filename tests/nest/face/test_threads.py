"""Simulators of one nest can be used from several threads."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.journal import Entry
from beliefnest.timeline.store import Journal

WALKS = {
    ("/", "sally"): "await goToPosition(bot, new Vec3(0, -51, -8))",
    ("/sally", "sally"): "await goToPosition(bot, new Vec3(4, -51, 5)); think(bot, 'there')",
    ("/observer", "anne"): "await goToPosition(bot, new Vec3(-4, -51, 5))",
}


def test_programs_of_several_threads_do_what_they_do_one_after_the_other(tmp_path: Path) -> None:
    one_by_one = _recorded(tmp_path / "one.bn", threads=1)
    side_by_side = _recorded(tmp_path / "several.bn", threads=len(WALKS))
    assert all(one_by_one.values())
    assert side_by_side == one_by_one


def _recorded(store: Path, threads: int) -> dict[tuple[tuple[str, ...], str], list[Entry]]:
    start = Barrier(threads)

    def act(place: tuple[str, str]) -> bool:
        path, agent = place
        start.wait()
        result = nest[path].run(agent, WALKS[place])
        return result.ok and nest[path].state.agents[agent].position is not None

    with Nest.open(Scenario.load("sally-anne", 3), store=store, seed=3) as nest:
        for path, _ in WALKS:
            if path != "/":
                nest[path].switch("plan")
        with ThreadPoolExecutor(threads) as pool:
            assert all(pool.map(act, WALKS))
    with Journal.read(store) as journal:
        return {
            (info.key.path, info.key.branch): list(journal.entries(info.key, 0, info.entries))
            for info in journal.timelines()
        }
