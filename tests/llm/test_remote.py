"""Providers' models, against a local server that speaks OpenAI's protocol."""

import asyncio
import re
import sys
import traceback

import pytest

from beliefnest.errors import InputError, ModelError, UnknownNameError
from beliefnest.llm import (
    AnswerLimits,
    Connection,
    Message,
    RetryPolicy,
    Sampling,
    model_names,
    open_model,
    read_answer,
    resolve_model,
)
from beliefnest.llm.failures import TransientModelError, UnavailableModelError
from beliefnest.llm.providers import PROVIDERS, endpoint
from beliefnest.llm.resolve import check_model

KEY = "sk-a-very-secret-key"
ASK = (Message("system", "Be brief."), Message("user", "Get a diamond."))
PROGRAM = "```javascript\nawait doNothing(bot);\n```"


def environment(fake, **more):
    return {"OPENAI_BASE_URL": fake.url, "OPENAI_API_KEY": KEY, **more}


def model(fake, clock, name="openai:gpt-4o-mini", **limits):
    return resolve_model(name, environment(fake), limits=AnswerLimits(**limits))


def test_an_answer_with_its_usage_and_cost(fake, clock):
    fake.will(fake.says(PROGRAM))
    answer = model(fake, clock).answer(ASK, Sampling(temperature=0.25, seed=7))
    assert answer.text == PROGRAM
    assert (answer.usage.requests, answer.usage.input_tokens, answer.usage.output_tokens) == (
        1,
        120,
        30,
    )
    assert answer.usage.cost is not None
    assert 0 < answer.usage.cost < 0.01
    (request,) = fake.requests
    assert request.path == "/v1/chat/completions"
    assert request.headers["authorization"] == f"Bearer {KEY}"
    assert (request.body["temperature"], request.body["seed"]) == (0.25, 7)
    assert [(m["role"], m["content"]) for m in request.body["messages"]] == [
        (m.role, m.text) for m in ASK
    ]


def test_what_the_sampling_leaves_open_is_not_sent(fake, clock):
    fake.will(fake.says(PROGRAM))
    model(fake, clock).answer(ASK, Sampling(temperature=None, max_output_tokens=None))
    sent = fake.requests[0].body
    assert not {"temperature", "seed", "max_tokens", "max_completion_tokens"} & set(sent)


def test_a_conversation_keeps_its_order(fake, clock):
    fake.will(fake.says(PROGRAM))
    talk = (*ASK, Message("assistant", "Here."), Message("user", "Again."))
    model(fake, clock).answer(talk, Sampling())
    roles = [message["role"] for message in fake.requests[0].body["messages"]]
    assert roles == ["system", "user", "assistant", "user"]


def test_several_answers_from_one_model(fake, clock):
    fake.will(fake.says("one();"), fake.says("two();"))
    asked = model(fake, clock)
    assert [asked.answer(ASK, Sampling()).text for _ in range(2)] == ["one();", "two();"]


def test_an_answer_while_an_event_loop_runs(fake, clock):
    fake.will(fake.says(PROGRAM))

    async def notebook():
        return model(fake, clock).answer(ASK, Sampling())

    assert asyncio.run(notebook()).text == PROGRAM


def test_a_server_that_counts_nothing_is_guessed_for(fake, clock):
    fake.will(fake.says(PROGRAM, usage=False))
    usage = model(fake, clock).answer(ASK, Sampling()).usage
    assert (usage.input_tokens, usage.output_tokens) == (6, 10)
    assert usage.cost is None


@pytest.mark.parametrize("provider", ["ollama", "vllm", "lmstudio"])
def test_servers_of_one_s_own_need_no_key_and_cost_nothing(fake, clock, provider):
    fake.will(fake.says(PROGRAM))
    own = {f"{provider.upper()}_BASE_URL": fake.url}
    asked = resolve_model(f"{provider}:qwen3:8b", own)
    assert asked.name == f"{provider}:qwen3:8b"
    assert asked.answer(ASK, Sampling()).usage.cost == 0.0
    assert fake.requests[0].body["model"] == "qwen3:8b"
    assert KEY not in str(fake.requests[0].headers)


def test_any_compatible_server(fake, clock):
    fake.will(fake.says(PROGRAM))
    own = {"COMPATIBLE_BASE_URL": fake.url, "COMPATIBLE_API_KEY": KEY}
    asked = resolve_model("compatible:some-model", own)
    assert asked.answer(ASK, Sampling()).usage.cost == 0.0
    assert fake.requests[0].headers["authorization"] == f"Bearer {KEY}"
    costs = {
        url: endpoint(PROVIDERS["compatible"], {"COMPATIBLE_BASE_URL": url}).cost(None)
        for url in ("http://192.168.1.7:8000/v1", "https://api.example.org/v1")
    }
    assert list(costs.values()) == [0.0, None]


FAULTS = [
    ("hangs_up", r"dropped the connection"),
    ("drops_halfway", r"dropped the connection"),
    ("answers_with_a_page", r"gave no usable answer"),
    ("garbles", r"Failed to decode response"),
    ("fails_halfway", r"failed .*overloaded"),
]


@pytest.mark.parametrize(("behaviour", "message"), FAULTS)
def test_faulty_servers_are_told_apart(fake, clock, behaviour, message):
    fake.will(getattr(fake, behaviour))
    with pytest.raises(ModelError, match=f"^openai:gpt-4o-mini.*{message}"):
        model(fake, clock).answer(ASK, Sampling())


@pytest.mark.parametrize(
    ("status", "code", "message"),
    [
        (401, "invalid_api_key", "refused the key in OPENAI_API_KEY"),
        (404, "model_not_found", "was not found: check the model's name"),
        (402, "insufficient_quota", "no credit left"),
        (400, "context_length_exceeded", "longer than the model can read"),
        (400, "bad_thing", "rejected the request"),
    ],
)
def test_requests_that_cannot_succeed(fake, clock, status, code, message):
    fake.will(fake.fails(status, code=code))
    with pytest.raises(ModelError, match=message) as caught:
        model(fake, clock).answer(ASK, Sampling())
    assert not isinstance(caught.value, TransientModelError)


def test_the_reason_for_the_end_of_an_answer_is_kept(fake, clock):
    fake.will(
        fake.says("  \n"),
        fake.says("await go", reason="length"),
        fake.refuses,
        fake.says(PROGRAM, reason="content_filter"),
    )
    asked = model(fake, clock)
    answers = [asked.answer(ASK, Sampling()) for _ in range(4)]
    assert [(each.text, each.finish) for each in answers] == [
        ("  \n", "stop"),
        ("await go", "length"),
        ("I will not steal diamonds.", "content_filter"),
        (PROGRAM, "content_filter"),
    ]
    assert all(each.usage.requests == 1 for each in answers)


@pytest.mark.parametrize(
    ("reason", "finish"),
    [
        *(
            (each, "stop")
            for each in ("stop", "eos_token", "stop_sequence", "END_TURN", "tool_calls", "plum")
        ),
        *(
            (each, "length")
            for each in ("max_tokens", "MAX_TOKENS", "model_length", "abort", "error")
        ),
        *((each, "content_filter") for each in ("guardrail_intervened", "SAFETY", "refusal")),
    ],
)
def test_reasons_by_other_names_do_not_make_a_cut_answer_whole(fake, clock, reason, finish):
    fake.will(fake.says("left", reason=reason))
    answer = model(fake, clock).answer(ASK, Sampling())
    assert (answer.text, answer.finish) == ("left", finish)


def test_an_answer_without_end_is_cut_off(fake):
    fake.will(fake.drips)
    answer = model(fake, None, characters=200).answer(ASK, Sampling())
    assert (answer.text, answer.finish) == ("x" * 201, "length")


def test_a_slow_answer_is_heard_to_its_end(fake):
    """Each pause is short, and all of them together are longer than the greatest silence."""
    fake.will(lambda handler: fake.drips_slowly(handler, letters=12, pause=0.1))
    answer = model(fake, None, seconds=0.8, first_token_seconds=5).answer(ASK, Sampling())
    assert (answer.text, answer.finish) == ("x" * 12, "stop")


def test_a_server_that_falls_silent_is_given_up(fake):
    def stops(handler):
        handler.start_stream()
        handler.send_chunk(delta={"role": "assistant", "content": "await"})
        fake.says_nothing(handler)

    fake.will(stops)
    silent = r"sent nothing for 0\.2 s in the middle of its answer; wait longer \(--answer-seconds"
    with pytest.raises(ModelError, match=silent):
        model(fake, None, seconds=0.2).answer(ASK, Sampling())


def test_the_first_token_has_a_limit_of_its_own(fake):
    fake.will(fake.says_nothing)
    with pytest.raises(ModelError, match=r"no token in 0\.2 s; wait longer \(--first-token-sec"):
        model(fake, None, first_token_seconds=0.2).answer(ASK, Sampling())


def test_nobody_listens():
    own = {"OLLAMA_BASE_URL": "http://127.0.0.1:1/v1"}
    nobody = r"no server for ollama:x at http://127\.0\.0\.1:1/v1: start it, or set OLLAMA_BASE_URL"
    for ask in (
        lambda: open_model("ollama:x", own, Connection()).answer(ASK, Sampling()),
        lambda: check_model("ollama:x", own, Connection()),
    ):
        with pytest.raises(UnavailableModelError, match=nobody):
            ask()


def test_the_key_is_in_no_message_traceback_or_representation(fake, clock):
    fake.will(fake.fails(400, f"bad request by {KEY}"), fake.fails(500, f"{KEY} broke"))
    asked = model(fake, clock)
    assert KEY not in repr(asked)
    for _ in range(2):
        with pytest.raises(ModelError, match=r"\*\*\*") as caught:
            asked.answer(ASK, Sampling())
        assert KEY not in "".join(traceback.format_exception(caught.value))


def connection(clock, **options):
    return Connection(clock=clock, retries=RetryPolicy(attempts=3, first_wait=1.0), **options)


def test_rate_limits_and_faults_are_waited_out(fake, clock):
    fake.will(fake.fails(429, headers=[("Retry-After", "7")]), fake.hangs_up, fake.says(PROGRAM))
    asked = open_model("openai:gpt-4o-mini", environment(fake), connection(clock))
    assert asked.answer(ASK, Sampling()).text == PROGRAM
    assert clock.waits == [7.0, 2.0]


def test_a_quota_is_waited_for_as_often_and_as_long_as_it_says(fake, clock):
    told = []
    asks_to_wait = fake.fails(429, headers=[("Retry-After", "150")])
    fake.will(*[asks_to_wait] * 9, fake.says(PROGRAM))
    asked = open_model("openai:gpt-4o-mini", environment(fake), connection(clock, tell=told.append))
    assert asked.answer(ASK, Sampling()).text == PROGRAM
    assert clock.waits == [60.0, 60.0, 30.0] * 9
    assert [line.partition("; ")[2].partition(" as")[0] for line in told[:3]] == [
        "waiting 150 s",
        "waiting 90 s",
        "waiting 30 s",
    ]


def test_retries_end(fake, clock):
    fake.will(fake.fails(503))
    asked = open_model("openai:gpt-4o-mini", environment(fake), connection(clock))
    with pytest.raises(ModelError, match="gave up after 3 requests"):
        asked.answer(ASK, Sampling())
    assert clock.waits == [1.0, 2.0]
    assert len(fake.requests) == 3


def test_nobody_waits_for_two_days(fake, clock):
    fake.will(fake.fails(429, headers=[("Retry-After", "172800")]))
    asked = open_model("openai:gpt-4o-mini", environment(fake), connection(clock))
    with pytest.raises(UnavailableModelError, match="asks to wait 172,800 s"):
        asked.answer(ASK, Sampling())
    assert clock.waits == []


def test_what_cannot_succeed_is_not_tried_again(fake, clock):
    fake.will(fake.fails(401))
    asked = open_model("openai:gpt-4o-mini", environment(fake), connection(clock))
    with pytest.raises(ModelError, match="refused the key"):
        asked.answer(ASK, Sampling())
    assert len(fake.requests) == 1


@pytest.mark.parametrize(
    ("name", "variable"),
    [
        ("openai:gpt-4o", "OPENAI_API_KEY"),
        ("anthropic:claude", "ANTHROPIC_API_KEY"),
        ("google:gemini", "GOOGLE_API_KEY or GEMINI_API_KEY"),
        ("compatible:x", "COMPATIBLE_BASE_URL"),
    ],
)
def test_what_is_missing_in_the_environment_is_named(name, variable):
    with pytest.raises(ModelError, match=variable):
        resolve_model(name, {})


OTHERS = [
    ("anthropic:some-claude", "ANTHROPIC_BASE_URL", "ANTHROPIC_API_KEY", "/v1/messages"),
    ("google:gemini-2.5-flash", "GOOGLE_GEMINI_BASE_URL", "GEMINI_API_KEY", "GenerateContent"),
]


@pytest.mark.extra("anthropic", "google.genai")
@pytest.mark.parametrize(("name", "url_variable", "key_variable", "path"), OTHERS)
def test_other_protocols_are_spoken(fake, clock, name, url_variable, key_variable, path):
    fake.will(fake.says_as(name.partition(":")[0], PROGRAM), fake.fails(401))
    own = {url_variable: fake.url.removesuffix("/v1"), key_variable: KEY}
    asked = resolve_model(name, own)
    answer = asked.answer(ASK, Sampling(temperature=0.5))
    assert answer.text == PROGRAM
    assert (answer.usage.input_tokens, answer.usage.output_tokens) == (120, 30)
    assert path.lower() in fake.requests[0].path.lower()
    assert "Get a diamond." in str(fake.requests[0].body)
    with pytest.raises(ModelError, match=f"refused the key in {key_variable}"):
        asked.answer(ASK, Sampling())


def test_unknown_and_incomplete_names():
    with pytest.raises(UnknownNameError, match=r"'opnai:x'; did you mean openai\?.*replay:FILE"):
        resolve_model("opnai:x", {})
    with pytest.raises(InputError, match="openai:MODEL"):
        resolve_model("openai", {})
    assert {"offline", "replay:FILE", "scripted:FILE", "openai:MODEL"} <= set(model_names())


def test_the_missing_extra_is_named(fake, clock, monkeypatch):
    monkeypatch.setitem(sys.modules, "pydantic_ai", None)
    with pytest.raises(ModelError, match=r"pip install 'beliefnest\[llm\]'"):
        model(fake, clock).answer(ASK, Sampling())


def test_the_extra_is_named_where_the_package_of_one_provider_is_missing(fake, clock, monkeypatch):
    for name in ("anthropic", "pydantic_ai.models.anthropic", "pydantic_ai.providers.anthropic"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "anthropic", None)
    own = {"ANTHROPIC_BASE_URL": fake.url, "ANTHROPIC_API_KEY": KEY}
    asked = resolve_model("anthropic:some-claude", own)
    with pytest.raises(ModelError, match=r"pip install 'beliefnest\[llm\]'"):
        asked.answer(ASK, Sampling())


@pytest.mark.parametrize("size", [1, 3, 7, 1000])
@pytest.mark.parametrize(
    "text", ["<think>Answer: B</think>Answer: A", "[THINK]B[/THINK]A", "Answer: A"]
)
def test_thinking_in_the_content_is_read_however_the_answer_is_cut(fake, size, text):
    parts = [text[at : at + size] for at in range(0, len(text), size)]
    whole_marks = [part for part in re.split(r"(</?think>)", text) if part]
    for chunks in (parts, whole_marks):

        def behave(handler, chunks=chunks):
            handler.start_stream()
            for chunk in chunks:
                handler.send_chunk(delta={"role": "assistant", "content": chunk})
            handler.end_stream()

        fake.will(behave)
        answer = resolve_model("openai:m", environment(fake)).answer(ASK, Sampling())
        reading = read_answer(answer.text, ["red box", "blue box"], answer.finish)
        assert (answer.text, reading.option) == (text, "red box")
