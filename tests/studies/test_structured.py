"""Questions with options asked in the structured form of a provider."""

import json

import pytest
from tests.llm.conftest import FakeOpenAI, serving
from tests.studies.test_doors import ROOM

import beliefnest as bn
from beliefnest.episodes.policies import resolve_policy
from beliefnest.llm.remote import RemoteModel

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture
def server(monkeypatch):
    with serving() as served:
        monkeypatch.setenv("VLLM_BASE_URL", served.url)
        yield served


def study(tmp_path, model="vllm:m", **keys):
    (tmp_path / "room.yaml").write_text(ROOM, encoding="utf-8")
    return bn.Study([str(tmp_path / "room.yaml")], models=[model], world="scripted", **keys)


def calls_a_tool(handler):
    """Answer with the call of a tool, in pieces."""
    handler.start_stream()
    function = {"name": "answer", "arguments": ""}
    begin = {"index": 0, "id": "c1", "type": "function", "function": function}
    handler.send_chunk(delta={"role": "assistant", "tool_calls": [begin]})
    for piece in ('{"answer": "re', 'd box"}'):
        more = {"index": 0, "function": {"arguments": piece}}
        handler.send_chunk(delta={"tool_calls": [more]})
    handler.end_stream(reason="tool_calls")


def calls_it_whole(handler):
    function = {"name": "answer", "arguments": '{"answer": "red box"}'}
    call = {"id": "c1", "type": "function", "function": function}
    message = {"role": "assistant", "content": None, "tool_calls": [call]}
    FakeOpenAI.answers_whole(FakeOpenAI.completion(message, "tool_calls"))(handler)


def test_options_are_asked_for_by_a_schema_and_rows_say_so(server, tmp_path):
    server.will(FakeOpenAI.says('{"answer": "red box"}'))
    plain = study(tmp_path).plan().cells[0].key.name
    structured = study(tmp_path, answer="structured")
    assert structured.plan().cells[0].key.name != plain
    (row,) = structured.run(tmp_path / "st", jobs=1).frame().to_dict("records")
    assert (row["ok"], row["answered"], row["form"]) == (True, "red box", "schema")
    (request,) = server.requests
    wanted = request.body["response_format"]["json_schema"]
    assert wanted["strict"]
    assert sorted(wanted["schema"]["properties"]["answer"]["enum"]) == ["blue box", "red box"]
    # What was stored is played again without the server, as what it was.
    again = study(tmp_path, answer="structured").run(tmp_path / "st", jobs=1)
    assert list(again.frame()["form"]) == ["schema"]
    assert len(server.requests) == 1


@pytest.mark.parametrize("calls", [calls_a_tool, calls_it_whole])
def test_a_tool_takes_the_place_of_a_schema_that_a_model_lacks(
    server, tmp_path, monkeypatch, calls
):
    chosen = RemoteModel._parameters

    def without_schemas(self, model, options):
        model.profile["supports_json_schema_output"] = False
        return chosen(self, model, options)

    monkeypatch.setattr(RemoteModel, "_parameters", without_schemas)
    server.will(calls)
    result = study(tmp_path, answer="structured").run(tmp_path / "st", jobs=1)
    (row,) = result.frame().to_dict("records")
    assert (row["answered"], row["form"]) == ("red box", "tool")
    (tool,) = server.requests[0].body["tools"]
    assert tool["function"]["name"] == "answer"


def test_usual_answers_are_text_and_requests_are_as_they_were(server, tmp_path):
    server.will(FakeOpenAI.says("Answer: red box"))
    result = study(tmp_path).run(tmp_path / "st", jobs=1)
    (row,) = result.frame().to_dict("records")
    assert row["form"] == "text"
    told = result.methods()
    assert "Models were asked at temperature 0" in told
    assert "for a program" not in told
    assert "response_format" not in server.requests[0].body
    stored = next((tmp_path / "st" / "answers").glob("*.json")).read_text(encoding="utf-8")
    assert set(json.loads(stored)["sampling"]) == {"temperature", "seed", "max_output_tokens"}


@pytest.mark.parametrize("model", ["offline", "chance", "first-option"])
def test_a_model_without_such_a_form_is_refused_by_name(tmp_path, model):
    with pytest.raises(bn.InputError, match=f"model {model} has no structured form"):
        study(tmp_path, model, answer="structured").run(tmp_path / "st", jobs=1)


def test_other_values_and_policies_are_refused(tmp_path):
    with pytest.raises(bn.InputError, match="answer is 'json'; give one of text, structured"):
        study(tmp_path, answer="json")
    with pytest.raises(bn.InputError, match="policies answer with programs; leave out `answer`"):
        resolve_policy("model:offline:1?answer=structured", {})
