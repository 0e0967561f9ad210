"""Settings of requests: as policies name them, as cells record them, and what models get."""

import pytest

from beliefnest.episodes.policies import policy_beside, resolve_policy, text_of_policy, with_query
from beliefnest.errors import InputError
from beliefnest.llm import Answer, Message, Sampling
from beliefnest.llm.model_settings import ModelSettings, WithSystem, query_of
from beliefnest.prompts import instructions
from beliefnest.skills import skills, skills_at


class Listening:
    name = "listening"

    def answer(self, messages, sampling):
        self.asked = messages
        return Answer("ok")


def test_settings_go_through_the_name_of_a_policy(tmp_path):
    file = tmp_path / "my system.txt"
    file.write_text("Be brief.", encoding="utf-8")
    query = query_of(file, {"max_output_tokens": 50, "answer_seconds": 2.5, "skills": None})
    policy = resolve_policy(with_query("model:offline:1", query))
    assert policy.settings == ModelSettings(2.5, max_output_tokens=50, system="Be brief.")
    assert policy.order == 1
    assert ModelSettings.of_chosen({"world": "scripted", **policy.settings.chosen}) == (
        policy.settings
    )


def test_the_settings_of_a_policy_count_before_those_of_a_study():
    named = with_query("model:offline:omniscient?skills=none", "skills=names&max_output_tokens=9")
    settings = resolve_policy(named).settings
    assert (settings.skills, settings.max_output_tokens) == ("none", 9)
    assert with_query("search:1", "skills=names") == "search:1"


def test_the_file_of_a_policy_is_beside_its_study(tmp_path):
    (tmp_path / "s.txt").write_text("Be brief.", encoding="utf-8")
    named = policy_beside("model:offline:0?system=s.txt", tmp_path)
    assert text_of_policy(named) == "Be brief."
    assert resolve_policy(named).settings.system == "Be brief."


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ("skill=names", "there is no setting 'skill'; give answer, answer_seconds, first_token"),
        ("skills=few", "skills is 'few'; give one of none"),
        ("answer_seconds=soon", "answer_seconds is 'soon'; give seconds"),
        ("answer_seconds=-1", "answer_seconds is -1"),
        ("first_token_seconds=nan", "first_token_seconds is nan"),
        ("max_output_tokens=1.5", "max_output_tokens is 1.5"),
        ("system=/nowhere/s.txt", "the system message /nowhere/s.txt cannot be read"),
    ],
)
def test_wrong_settings_of_a_policy_are_named(query, told):
    with pytest.raises(InputError, match=f"'model:offline:1.{query}': {told}"):
        resolve_policy(f"model:offline:1?{query}")


def test_a_system_message_of_one_s_own_replaces_the_built_in_one():
    model = Listening()
    asked = (Message("system", "Ours."), Message("user", "Go."))
    WithSystem(model, "Yours.").answer(asked, Sampling())
    assert [(m.role, m.text) for m in model.asked] == [("system", "Yours."), ("user", "Go.")]


def test_the_list_of_skills_has_the_detail_that_is_asked_for():
    texts = {
        each: instructions(skills_at(each)) for each in ("none", "names", "signatures", "full")
    }
    assert [len(text) for text in texts.values()] == sorted(len(text) for text in texts.values())
    assert texts["full"] == instructions(tuple(each for each in skills() if each.listed))
    assert "openContainer" not in texts["full"].replace("bot.openContainer", "")
    assert "You can call" not in texts["none"]
    assert "\ngoToPosition\n" in texts["names"]
    assert "\ngoToPosition(bot, position, dist=2)\n" in texts["signatures"]
    assert all(skill.description not in texts["signatures"] for skill in skills())
