"""A person is one of the agents of an episode, at a Minecraft client."""

import itertools
from typing import Any

import pytest
from tests.people import Person
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.episodes.policies import Scripted
from beliefnest.world.values import EventKind

CHEST = (5, 1, 1)
ANSWERS = """
const asked = await waitForChat(bot, 12000)
await say(bot, `${asked.speaker}, it is over there.`)
"""
ASKS_AND_TAKES = """
let told = false
bot.on('chat', who => { told ||= who === 'ann' })
while (!told) {
  bot.chat('Where is it?')
  await bot.waitForTicks(25)
}
await getItemFromChest(bot, new Vec3(5, 1, 1), {apple: 1})
"""


def hall() -> bn.Task:
    content: dict[str, Any] = {
        "name": "hall",
        "scenario": {
            "name": "hall",
            "box": [[0, 0, 0], [8, 3, 6]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 6]]}],
            "static_blocks": ["stone"],
            "containers": [{"at": list(CHEST), "items": {"apple": 1}}],
            "agents": {
                "ann": {"position": [1.5, 1, 5.5]},
                "bob": {"position": [3.5, 1, 3.5]},
            },
        },
        "goal": {
            "reach": [
                {"agent": "bob", "items": {"apple": 1}},
                {"path": "/ann", "agent": "bob", "items": {"apple": 1}},
            ]
        },
        "talk": ["ann", "bob"],
        "rounds": 60,
        "round_ticks": 20,
        "pace": 5,
    }
    return bn.Task.from_mapping(content)


@pytest.mark.parametrize("policy", few_by_day(["person", "person:wait"]))
def test_what_a_person_does_in_a_round_is_their_agent_s_action(policy: str) -> None:
    ann = Scripted([ANSWERS, *[bn.GO_ON] * 59])
    with (
        bn.Episode(hall(), {"ann": ann, "bob": policy}, world="embedded", listen=0) as episode,
        Person(episode.address, "bob") as bob,
    ):
        episode.play(0)
        bob.does(ASKS_AND_TAKES)
        assert episode.play().success
        assert episode.nest.wait(lambda: bob.is_done)
        assert episode.policies["bob"] == policy
        chat = [(who, text) for _, who, text in episode.nest["/"].state.chat]
        assert chat[0] == ("bob", "Where is it?")
        assert ("ann", "bob, it is over there.") in chat
        deeds = {e.kind for e in episode.nest["/ann"].state.events if e.actor == "bob"}
        assert EventKind.GET_ITEM_FROM_CHEST in deeds
        assert any(part.ended["bob"].how == "ok" for part in episode.parts)
        assert all(not part.decisions["bob"].program for part in episode.parts)
        # Rounds follow one another, each at least as long as it takes.
        began = [*episode.beginnings, episode.nest.tick]
        assert all(later > earlier for earlier, later in itertools.pairwise(began))
        assert episode.measures.messages >= 2
        with pytest.raises(bn.InputError, match="people cannot repeat their acts exactly"):
            episode.help()


def test_people_join_the_embedded_world_alone() -> None:
    with pytest.raises(bn.InputError, match="people cannot join the world 'scripted'"):
        bn.Episode(hall(), {"bob": "person"})
    with pytest.raises(bn.InputError, match="no agent has the policy"):
        bn.Episode(hall(), world="embedded", listen=0)
