"""Limits, cache, recordings and scripts that a run puts around a model."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from beliefnest.errors import InputError, ModelError
from beliefnest.llm import (
    Connection,
    Message,
    RunLimits,
    RunSpending,
    Sampling,
    Usage,
    open_model,
    resolve_model,
)
from beliefnest.llm.budget import MeteredModel
from beliefnest.llm.messages import Answer

KEY = "sk-a-very-secret-key"
ASK = (Message("user", "Get a diamond."),)
OTHER = (Message("user", "Get an emerald."),)


class Priced:
    """Answers everything at a fixed price."""

    name = "priced"

    def __init__(self, usage):
        self.usage = usage
        self.asked = 0

    def answer(self, messages, sampling):
        self.asked += 1
        return Answer("a();", self.usage)


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        (RunLimits(tokens=400, cost=None), r"has used 450 tokens and may use 400"),
        (RunLimits(tokens=450, cost=None), r"has used 450 tokens and may use 450"),
        (RunLimits(tokens=None, cost=2.0), r"has cost 2\.25 US dollars and may cost 2\.00"),
    ],
)
def test_a_run_may_not_spend_more_than_its_limits(limits, message):
    priced = Priced(Usage(1, 100, 50, 0.75))
    metered = MeteredModel(priced, RunSpending(limits))
    for _ in range(3):
        metered.answer(ASK, Sampling())
    with pytest.raises(ModelError, match=message):
        metered.answer(ASK, Sampling())
    assert priced.asked == 3


def test_limits_are_on_by_default():
    for usage in (Usage(1, 2_000_000, 0, None), Usage(1, 1, 1, 6.0)):
        metered = MeteredModel(Priced(usage), RunSpending())
        metered.answer(ASK, Sampling())
        with pytest.raises(ModelError, match="raise the limit"):
            metered.answer(ASK, Sampling())


def test_the_default_limit_of_tokens_does_not_stop_a_free_server():
    free, paid = Usage(1, 2_000_000, 0, 0.0), Usage(1, 600_000, 0, None)
    spending = RunSpending()
    for usage in (free, paid, free):
        MeteredModel(Priced(usage), spending).answer(ASK, Sampling())
    MeteredModel(Priced(paid), spending).answer(ASK, Sampling())
    with pytest.raises(ModelError, match=r"used 1,200,000 tokens .*: --max-tokens, or max_tokens"):
        MeteredModel(Priced(free), spending).answer(ASK, Sampling())


def test_a_limit_of_tokens_that_somebody_set_stops_a_free_server_too():
    metered = MeteredModel(Priced(Usage(1, 500, 0, 0.0)), RunSpending(RunLimits(tokens=400)))
    metered.answer(ASK, Sampling())
    with pytest.raises(ModelError, match="may use 400"):
        metered.answer(ASK, Sampling())


def test_every_answer_is_paid_however_it_ended(fake, clock):
    half_an_emoji = fake.says("go('\ud83d');")
    fake.will(fake.refuses, fake.says("await go", reason="length"), half_an_emoji)
    budget = RunSpending()
    asked = cached(fake, clock, None, budget=budget)
    for _ in range(2):
        asked.answer(ASK, Sampling())
    with pytest.raises(ModelError):
        asked.answer(ASK, Sampling())
    assert budget.spent.requests == 3
    assert budget.spent.tokens == 450


def test_the_reason_for_the_end_of_an_answer_is_kept_and_recorded(fake, clock, tmp_path):
    fake.will(fake.says("await go", reason="length"))
    cut = cached(fake, clock, tmp_path / "c", record=tmp_path / "r.jsonl").answer(ASK, Sampling())
    replay = resolve_model(f"replay:{tmp_path / 'r.jsonl'}", {})
    for again in (cached(fake, clock, tmp_path / "c"), replay):
        assert again.answer(ASK, Sampling()) == replace(cut, cached=True)
    assert cut.finish == "length"


def test_usage_adds_up_and_an_unknown_price_stays_unknown():
    assert Usage(1, 2, 3, 0.5) + Usage(1, 1, 1, 0.25) == Usage(2, 3, 4, 0.75)
    assert (Usage(1, 2, 3, 0.5) + Usage(1, 1, 1, None)).cost is None


def cached(fake, clock, folder, mode="read", **options):
    environment = {"OPENAI_BASE_URL": fake.url, "OPENAI_API_KEY": KEY}
    connection = Connection(cache=folder, cache_mode=mode, clock=clock, **options)
    return open_model("openai:gpt-4o-mini", environment, connection)


def test_a_run_is_repeated_from_its_cache_without_the_model(fake, clock, tmp_path):
    fake.will(fake.says("one();"), fake.fails(500))
    first = cached(fake, clock, tmp_path / "cache").answer(ASK, Sampling(seed=1))
    budget = RunSpending(RunLimits(tokens=0))
    again = cached(fake, clock, tmp_path / "cache", budget=budget).answer(ASK, Sampling(seed=1))
    assert again == replace(first, cached=True)
    assert len(fake.requests) == 1
    assert budget.spent == Usage()


@pytest.mark.parametrize(
    ("messages", "sampling", "name"),
    [
        (OTHER, Sampling(seed=1), "openai:gpt-4o-mini"),
        (ASK, Sampling(seed=2), "openai:gpt-4o-mini"),
        (ASK, Sampling(seed=1, temperature=0.5), "openai:gpt-4o-mini"),
        (ASK, Sampling(seed=1), "openai:gpt-4o"),
        ((Message("system", "Get a diamond."),), Sampling(seed=1), "openai:gpt-4o-mini"),
    ],
)
def test_the_cache_answers_only_exactly_the_same_request(
    fake, clock, tmp_path, messages, sampling, name
):
    fake.will(fake.says("one();"), fake.says("two();"))
    environment = {"OPENAI_BASE_URL": fake.url, "OPENAI_API_KEY": KEY}
    connection = Connection(cache=tmp_path, clock=clock)
    open_model("openai:gpt-4o-mini", environment, connection).answer(ASK, Sampling(seed=1))
    other = open_model(name, environment, connection).answer(messages, sampling)
    assert (other.text, other.cached) == ("two();", False)


def test_writing_asks_again_and_off_keeps_nothing(fake, clock, tmp_path):
    fake.will(fake.says("one();"), fake.says("two();"), fake.says("three();"))
    folder = tmp_path / "cache"
    assert cached(fake, clock, folder, "off").answer(ASK, Sampling()).text == "one();"
    assert not folder.exists()
    assert cached(fake, clock, folder, "write").answer(ASK, Sampling()).text == "two();"
    assert cached(fake, clock, folder, "write").answer(ASK, Sampling()).text == "three();"
    kept = cached(fake, clock, folder).answer(ASK, Sampling())
    assert (kept.text, kept.cached) == ("three();", True)


def test_a_failure_is_not_kept(fake, clock, tmp_path):
    fake.will(fake.fails(401), fake.says("one();"))
    asked = cached(fake, clock, tmp_path)
    with pytest.raises(ModelError):
        asked.answer(ASK, Sampling())
    assert asked.answer(ASK, Sampling()).text == "one();"


def test_a_damaged_kept_answer_is_named(fake, clock, tmp_path):
    fake.will(fake.says("one();"))
    cached(fake, clock, tmp_path).answer(ASK, Sampling())
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes()[:-10])
    with pytest.raises(ModelError, match=rf"{file.name} is damaged.*delete it"):
        cached(fake, clock, tmp_path).answer(ASK, Sampling())


def test_a_folder_that_cannot_be_written_is_named(fake, clock, tmp_path):
    fake.will(fake.says("one();"))
    (tmp_path / "file").write_text("")
    with pytest.raises(ModelError, match=r"cannot be (kept|read)"):
        cached(fake, clock, tmp_path / "file").answer(ASK, Sampling())


def test_a_recording_replays_and_holds_no_key(fake, clock, tmp_path):
    fake.will(fake.says("one();"), fake.says("two();"), fake.says("three();"))
    record = tmp_path / "run" / "model.jsonl"
    asked = cached(fake, clock, None, record=record)
    asked.answer(ASK, Sampling(seed=5))
    asked.answer(OTHER, Sampling())
    asked.answer(ASK, Sampling())
    content = record.read_text()
    assert KEY not in content
    assert fake.url not in content
    assert json.loads(content.splitlines()[0])["sampling"]["seed"] == 5

    replay = resolve_model(f"replay:{record}", {})
    texts = [replay.answer(m, Sampling()).text for m in (OTHER, ASK, ASK)]
    assert texts == ["two();", "one();", "three();"]
    with pytest.raises(ModelError, match="no further answer"):
        replay.answer(ASK, Sampling())
    with pytest.raises(ModelError, match=r"no answer to this prompt.*Get gold"):
        replay.answer((Message("user", "Get gold"),), Sampling())


def test_a_recording_that_was_cut_off_names_the_line(tmp_path):
    (tmp_path / "r.jsonl").write_text('{"model":')
    with pytest.raises(InputError, match=r"r\.jsonl, line 1"):
        resolve_model(f"replay:{tmp_path / 'r.jsonl'}", {})


def test_a_script_gives_its_answers_in_order(tmp_path):
    path = tmp_path / "script.json"
    path.write_text(json.dumps(["one", "two"]))
    model = open_model(f"scripted:{path}", {}, Connection(record=tmp_path / "r.jsonl"))
    assert [model.answer(ASK, Sampling()).text for _ in range(2)] == ["one", "two"]
    with pytest.raises(ModelError, match="no answer left"):
        model.answer(ASK, Sampling())
    assert len((tmp_path / "r.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize("content", ['{"a": 1}', "[1]", "nonsense"])
def test_a_script_of_another_form_is_refused(tmp_path, content):
    path = tmp_path / "script.json"
    path.write_text(content)
    with pytest.raises(InputError, match="not a JSON list of answers"):
        resolve_model(f"scripted:{path}", {})


@pytest.mark.parametrize("kind", ["replay", "scripted"])
def test_a_missing_file_is_named(kind):
    with pytest.raises(ModelError, match=r"gone\.json"):
        resolve_model(f"{kind}:/nowhere/gone.json", {})


def test_the_offline_model_needs_none_of_the_extra():
    program = (
        "import sys\n"
        "from beliefnest.llm import *\n"
        "open_model('offline', {}, Connection()).answer([Message('user', 'Task: x')], Sampling())\n"
        "sys.exit(any(name.startswith(('pydantic', 'openai', 'httpx')) for name in sys.modules))\n"
    )
    source = Path(__file__).parents[2] / "src"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": str(source)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
