"""Only agents in `talk` can speak, whatever their policies return."""

from pathlib import Path

import pytest
from tests.episodes.test_going_on import errand
from tests.shared_worlds import WORLDS

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import Scripted

pytestmark = pytest.mark.usefixtures("kept_worlds")

UTTERANCES = {
    "say": "await say(bot, 'hello')",
    "whisper": "await whisper(bot, 'bob', 'hello')",
    "chat": "bot.chat('hello')",
    "method": "bot.whisper('bob', 'hello'); await waitTicks(bot, 2)",
    "caught": "try { await say(bot, 'hello') } catch (error) { throw new Error(error.message) }",
}


def quiet(**talk: list[str]) -> bn.Task:
    content = errand(10).plain()
    content |= talk
    content["scenario"]["agents"]["bob"] = {"position": [3.5, 1, 1.5]}
    return bn.Task.from_mapping(content | {"players": ["ann", "bob"]})


@pytest.mark.parametrize("speech_ticks", [0, 4])
@pytest.mark.parametrize("world", WORLDS)
def test_who_may_not_speak_says_nothing(world: str, speech_ticks: int) -> None:
    task = quiet(talk=["bob"])
    task.form.scenario["perception"] = {"speech_ticks": speech_ticks}
    task = bn.Task.from_mapping(task.plain())
    policies = {"ann": Scripted([*UTTERANCES.values()]), "bob": Scripted(["await say(bot, 'hi')"])}
    with bn.Episode(task, policies, world=world) as episode:
        episode.play(len(UTTERANCES))
        assert [(who, text) for _, who, text in episode.nest["/"].state.chat] == [("bob", "hi")]
        ends = [part.ended["ann"] for part in episode.parts]
        assert [each.how for each in ends] == ["failed"] * len(UTTERANCES)
        reasons = [part.reasons["ann"] for part in episode.parts]
        assert all("ann may not speak here" in each for each in reasons), reasons
        assert episode.measures.failed_programs == len(UTTERANCES)


def test_who_may_not_speak_says_nothing_in_a_replay_of_the_run(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    caught = "try { await say(bot, 'hello') } catch { await goToPosition(bot, new Vec3(6, 1, 5)) }"
    policies = {"ann": Scripted([caught]), "bob": Scripted([])}
    with bn.Episode(quiet(talk=[]), policies, store=store) as episode:
        episode.play(2)
    assert run_command_line(["replay", str(store)]) == 0
