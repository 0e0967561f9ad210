"""Acts in a nest with a store, tells of each call that returned, until it is killed.

    python acting_nest.py STORE SEED

A process of `test_killed_process.py`; `calls` is what it does, also for the model in memory.
"""

import random
import sys
from collections.abc import Iterator, Sequence
from unittest.mock import patch

import beliefnest as bn
from beliefnest.llm import Answer, Message, Sampling
from beliefnest.nest.past.checkpoints import Pace

BOX = ((0, 0, 0), (6, 2, 6))
CHEST = (3, 0, 3)
AGENTS = {"ann": (1.5, 0.0, 1.5), "bob": (5.5, 0.0, 5.5)}
OFTEN = patch("beliefnest.nest.past.history.Pace", lambda: Pace(every=2, lag=1, stretch=3))
"""Makes nests that leave checkpoints every few entries, as others do in long runs."""

PATHS = ("/", "/ann", "/ann/bob", "/bob")


class _Model:
    """Answers with the question."""

    name = "echo"

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the last request."""
        return Answer(messages[-1].text)


def nest_in(store: str | None) -> bn.Nest:
    """Open the nest that is acted in."""
    world = bn.ScriptedWorld(BOX, agents=AGENTS, containers={CHEST: {"bread": 64}})
    return bn.Nest(world, static_blocks=["stone"], store=store)


def calls(nest: bn.Nest, seed: int) -> Iterator[None]:
    """Yield after each of very many calls on a nest."""
    chance = random.Random(seed)
    while True:
        simulator = nest[chance.choice(PATHS)]
        act = chance.randrange(9)
        if act == 0:
            names = ["one", "two"] if simulator.path == "/" else ["one", "two", "follow"]
            simulator.switch(chance.choice(names))
        elif act == 1:
            simulator.edit(containers={CHEST: {"bread": chance.randrange(1, 9)}})
        elif act == 8:
            question = f"{simulator.path} at {simulator.tick}?"
            simulator.noting(_Model()).answer([Message("user", question)], Sampling())
        elif simulator.mode == "follow":
            continue
        elif act == 2:
            simulator.step(chance.randrange(1, 4))
        elif act == 3:
            place = (chance.randrange(7), 1, chance.randrange(7))
            simulator.scripted.set_block(place, chance.choice(["stone", "glass"]))
        else:
            feet = (chance.randrange(7) + 0.5, 0.0, chance.randrange(7) + 0.5)
            present = sorted(simulator.scripted.snapshot().agents)
            simulator.scripted.place_agent(chance.choice(present), feet)
        yield


def main(store: str, seed: str) -> None:
    """Act until killed."""
    with OFTEN:
        nest = nest_in(store)
    for _ in calls(nest, int(seed)):
        sys.stdout.buffer.write(b".")
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
