"""Malformed answers of a server: each ends that answer alone, with one error."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.profiles import at_night

from beliefnest.errors import InputError, ModelError
from beliefnest.llm import Answer, AnswerLimits, Connection, Sampling, open_model, resolve_model
from beliefnest.llm.messages import Message

ASK = (Message("user", "Get a diamond."),)
MOST_TOKENS = 10**9


def chunk(**over):
    choice = {"index": 0, "finish_reason": None, "delta": {"role": "assistant", "content": "go();"}}
    made = {"id": "x", "object": "chat.completion.chunk", "created": 1, "model": "m"}
    return {**made, "choices": [choice], "usage": None, **over}


def delta(**content):
    return chunk(choices=[{"index": 0, "finish_reason": None, "delta": content}])


ENDING = chunk(choices=[{"index": 0, "finish_reason": "stop", "delta": {}}])


def counted(**over):
    counts = {"prompt_tokens": 12, "completion_tokens": 3, "total_tokens": 15, **over}
    return chunk(choices=[], usage=counts)


def sends(*events):
    def behave(handler):
        handler.start_stream()
        for event in (*events, b"[DONE]"):
            body = event if isinstance(event, bytes) else json.dumps(event).encode()
            handler.wfile.write(b"data: " + body + b"\n\n")

    return behave


def sends_for_ever(piece):
    def behave(handler):
        handler.start_stream()
        while not handler.fake.closing.is_set():
            handler.wfile.write(piece)

    return behave


def compresses(handler):
    handler.send_response(200)
    handler.send_header("Content-Type", "text/event-stream")
    handler.send_header("Content-Encoding", "gzip")
    handler.end_headers()


def remote(fake, *, name="openai:gpt-4o-mini", **limits):
    own = {"OPENAI_BASE_URL": fake.url, "OPENAI_API_KEY": "sk-secret"}
    return resolve_model(name, own, limits=AnswerLimits(**limits))


def asked(fake, **how):
    return remote(fake, **how).answer(ASK, Sampling())


def is_usable(answer):
    """Check that an answer can be stored, counted and sent back."""
    usage = answer.usage
    answer.text.encode()
    assert all(
        isinstance(count, int) and 0 <= count <= MOST_TOKENS
        for count in (usage.input_tokens, usage.output_tokens)
    )
    return usage.cost is None or 0 <= usage.cost < float("inf")


def one_line(error):
    text = str(error)
    text.encode()
    return text.isprintable() and len(text) < 1000 and "sk-secret" not in text


DEEP = 1_000_000
"""Lists in lists; Python 3.14 reads 50,000 of them."""

NONSENSE = {
    "null": [b"null"],
    "a number": [b"7"],
    "a list": [b"[]"],
    "brackets": [b"[" * 200_000],
    "braces": [b'{"a":' * 200_000],
    "deep content": [json.dumps(chunk()).replace('"go();"', "[" * DEEP + "]" * DEEP).encode()],
    "half an emoji": [delta(content="go('\ud83d');")],
    "6,000 digits": [json.dumps(counted()).replace("12", "1" * 6000).encode()],
    "usage in a list": [chunk(), chunk(usage=[1])],
    "no choice": [chunk(choices=[None])],
    "a delta of text": [chunk(choices=[{"index": 0, "delta": "go();"}])],
    "a call of nothing": [delta(tool_calls=[None])],
    "a refusal in pieces": [delta(refusal={"a": 1})],
    "a date": [chunk(created=1e300)],
    "bytes": [b'{"id": "\xff\xfe"}'],
    "an error of half an emoji": [{"error": {"message": "\ud83d\n\x1b[31m", "code": "\ud83d"}}],
}


@pytest.mark.parametrize("events", NONSENSE.values(), ids=NONSENSE)
def test_nonsense_ends_that_answer_with_one_error(fake, events):
    fake.will(sends(*events), fake.says("go();"))
    with pytest.raises(ModelError, match=r"^openai:gpt-4o-mini") as fault:
        asked(fake)
    assert one_line(fault.value)
    assert asked(fake).text == "go();"


@pytest.mark.parametrize(
    "count", [1e30, float("nan"), float("inf"), -5, "many", 10**40, True, [], None, 1.5]
)
def test_tokens_that_cannot_be_are_guessed(fake, count):
    fake.will(sends(chunk(), ENDING, counted(prompt_tokens=count)))
    assert is_usable(asked(fake))


def test_an_error_page_of_half_an_emoji_can_be_told(fake):
    fake.will(fake.fails(400, "\ud83d\u2028\x1b[31m"))
    with pytest.raises(ModelError) as fault:
        asked(fake)
    assert one_line(fault.value)


@pytest.mark.parametrize("piece", [b"x" * 65536, b": ping\n\n" * 8192, b"\n" * 65536])
def test_a_stream_without_end_or_event_is_given_up_by_its_bytes(fake, piece):
    fake.will(sends_for_ever(piece))
    with pytest.raises(ModelError, match="sent more than 1,048,576 bytes without text"):
        asked(fake, silent_bytes=2**20)


def test_a_stream_without_event_is_given_up_by_its_time(fake):
    def pings(handler):
        handler.start_stream()
        while not handler.fake.closing.wait(0.01):
            handler.wfile.write(b": ping\n\n")

    fake.will(pings)
    with pytest.raises(ModelError, match=r"sent no token in 0\.3 s"):
        asked(fake, first_token_seconds=0.3)


def test_what_is_compressed_is_refused(fake):
    fake.will(compresses)
    with pytest.raises(ModelError, match="compressed"):
        asked(fake)


def test_an_unreadable_answer_counts_against_the_run(fake, clock):
    fake.will(sends(b"null"))
    connection = Connection(clock=clock)
    own = {"OPENAI_BASE_URL": fake.url, "OPENAI_API_KEY": "sk-secret"}
    with pytest.raises(ModelError):
        open_model("openai:gpt-4o-mini", own, connection).answer(ASK, Sampling())
    assert connection.budget.spent.requests == 1
    assert connection.budget.spent.input_tokens > 0


@pytest.mark.parametrize("content", [b"[" * 200_000, b'["\\ud83d"]', b'["\xff"]', b"null", b""])
@pytest.mark.parametrize("kind", ["scripted", "replay"])
def test_files_of_answers_are_refused_in_one_line(tmp_path, kind, content):
    path = tmp_path / "answers.json"
    path.write_bytes(content or b"\n")
    with pytest.raises(InputError, match=r"answers\.json") as fault:
        resolve_model(f"{kind}:{path}", {})
    assert one_line(fault.value)


# --- the neighbourhood: a sound stream in which one thing after the other is something else

SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**40), 10**40),
    st.floats(),
    st.text(st.characters(), max_size=8),
    st.sampled_from(["\ud83d", "\u2028", "\x1b[31m", "stop", "x" * 50_000]),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner),
    max_leaves=6,
)
SOUND = [delta(role="assistant", content="go();"), delta(content="on();"), counted()]


def places(value, path=()):
    yield path
    parts = value.items() if isinstance(value, dict) else ()
    for key, part in enumerate(value) if isinstance(value, list) else parts:
        yield from places(part, (*path, key))


def with_value(value, path, other):
    if not path:
        return other
    head, *rest = path
    copy = dict(value) if isinstance(value, dict) else list(value)
    copy[head] = with_value(value[head], rest, other)
    return copy


@given(
    changes=st.lists(
        st.tuples(st.sampled_from(list(places(SOUND))[1:]), VALUES), min_size=1, max_size=2
    )
)
@settings(max_examples=settings().max_examples * 4)
def test_whatever_a_stream_holds_gives_an_answer_or_one_error(neighbour, changes):
    events = SOUND
    for path, value in sorted(changes, key=lambda each: -len(each[0])):
        if path in set(places(events)):
            events = with_value(events, path, value)
    neighbour.will(sends(*events))
    try:
        answer = asked(neighbour)
    except ModelError as fault:
        assert one_line(fault)
    else:
        assert isinstance(answer, Answer)
        assert is_usable(answer)


def told(*pieces, end="stop"):
    """Return the bytes of a good stream."""
    events = [delta(content=each) for each in pieces]
    events += [chunk(choices=[{"index": 0, "finish_reason": end, "delta": {}}]), counted()]
    lines = [json.dumps(each, ensure_ascii=False).encode() for each in events]
    return b"".join(b"data: " + line + b"\n\n" for line in (*lines, b"[DONE]"))


WHOLE = told("Answer: red ", "box or", " the blüe box")
ENDED = WHOLE.index(b'"stop"') + len(b'"stop", "delta": {}}], "usage": null}')


def sends_raw(events):
    def behave(handler):
        handler.start_stream()
        handler.wfile.write(events)

    return behave


@pytest.mark.parametrize("step", [211, pytest.param(at_night(1, 7), marks=pytest.mark.long)])
def test_half_an_answer_is_none(neighbour, step):
    for count in range(0, len(WHOLE) + 1, step):
        neighbour.will(sends_raw(WHOLE[:count]))
        try:
            answer = asked(neighbour)
        except ModelError as fault:
            assert one_line(fault)
        else:
            assert count >= ENDED
            assert answer.text == "Answer: red box or the blüe box"


@pytest.mark.parametrize("end", ["eos", "banana", "stop"])
def test_any_reason_ends_an_answer(neighbour, end):
    neighbour.will(
        lambda handler: (handler.start_stream(), handler.wfile.write(told("go();", end=end)))
    )
    assert asked(neighbour).finish == "stop"


UNEXPLAINED = told("Answer: red ", "box", end=None)


@pytest.mark.parametrize("size", [1, 7, len(UNEXPLAINED)])
def test_a_stream_to_its_mark_is_an_answer_without_a_reason(neighbour, size):
    def behave(handler, events=UNEXPLAINED):
        handler.start_stream()
        for at in range(0, len(events), size):
            handler.wfile.write(events[at : at + size])
            handler.wfile.flush()

    neighbour.will(behave)
    answer = asked(neighbour)
    assert (answer.text, answer.finish) == ("Answer: red box", "stop")


def test_a_cut_stream_without_a_reason_is_none(neighbour):
    said = json.dumps(delta(content="data: [DONE]\n\ndata: [DONE]")).encode()
    for events in (UNEXPLAINED[:-16], UNEXPLAINED[:-4], b"data: " + said + b"\n\n"):
        neighbour.will(sends_raw(events))
        with pytest.raises(ModelError, match="ended the stream in the middle"):
            asked(neighbour)


@pytest.mark.parametrize("reason", ["stop", None, "length"])
def test_a_server_that_does_not_stream_is_read(neighbour, reason):
    message = {"role": "assistant", "content": "Answer: red box"}
    neighbour.will(neighbour.answers_whole(neighbour.completion(message, reason)))
    answer = asked(neighbour)
    assert (answer.text, answer.finish) == ("Answer: red box", reason or "stop")
    assert answer.usage.input_tokens == 12


@pytest.mark.parametrize(
    "body", [b"{}", b"[]", b'{"choices": []}', b'{"choices": [{"message": {"tool_calls": 3}}]}',
             b'{"choices": [{"message": {"content": "Answer: A"', b"[" * 100_000, b"null", b""]
)  # fmt: skip
def test_a_whole_body_that_is_no_answer_is_refused(neighbour, body):
    neighbour.will(neighbour.answers_whole(body))
    with pytest.raises(ModelError) as caught:
        asked(neighbour)
    assert one_line(caught.value)


def test_an_answer_of_10_mb_in_one_line_is_cut(neighbour):
    neighbour.will(sends(delta(content="x" * 10_000_000)))
    assert asked(neighbour).finish == "length"
