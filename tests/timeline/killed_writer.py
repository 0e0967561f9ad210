"""A process that writes a run file until it is killed, telling each call that returned.

Run as `python killed_writer.py FILE SEED`. The calls depend on the seed alone.
"""

import os
import random
import sys
from pathlib import Path

from beliefnest.timeline.journal import Edit, ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

CALLS = 1200


def calls(journal, seed):
    """Make one call for each value asked for; on any journal, the same ones."""
    chance = random.Random(seed)
    keys = [TimelineKey((), "main")]
    journal.create(keys[0], None, 0)
    yield
    for number in range(1, CALLS):
        key = chance.choice(keys)
        info = journal.info(key)
        kind = chance.random()
        if kind < 0.8:
            length = chance.choice((1, 1, 1, 1, 1, 2, 5, 30, 150))
            ticks = range(info.head + 1, info.head + 1 + length)
            journal.append(key, [entry(tick, chance) for tick in ticks], ticks[-1])
        elif kind < 0.9:
            fork = TimelineKey(("sally",), f"branch {number}")
            journal.create(fork, ForkPoint(key, info.entries, info.head), info.head)
            keys.append(fork)
        elif kind < 0.95:
            journal.describe(key, f"after call {number}")
        elif key.path and not any(
            i.base is not None and i.base.timeline == key for i in journal.timelines()
        ):
            journal.delete(key)
            keys.remove(key)
        else:
            journal.rename(key, f"renamed {number}")
            renamed = TimelineKey(key.path, f"renamed {number}")
            keys[keys.index(key)] = renamed
        yield


def entry(tick, chance):
    """Return a frame or an edit."""
    if chance.random() < 0.1:
        return Edit(tick, ("sally",), {(tick, 0, 0): chance.randrange(100)})
    return Frame(tick, {"sally": AgentState((chance.random(), 1.0, chance.random()))})


def main(path, seed):
    """Write, tell each call that returned by one byte, and wait to be killed."""
    for _ in calls(Journal.create_file(Path(path)), int(seed)):
        os.write(1, b".")
    sys.stdin.read()


if __name__ == "__main__":
    main(*sys.argv[1:])
