"""Keys and passwords of a server: sent to it, and found nowhere else, whatever it repeats."""

import base64
import logging
import re
import traceback
from pathlib import Path
from urllib.parse import quote, urlsplit

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.llm.conftest import FakeClock, FakeOpenAI

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import ModelError
from beliefnest.llm import Connection, Message, RetryPolicy, Sampling, SystemClock, open_model
from beliefnest.llm.secrets import MASK, Secrets, without_password

KEY = "sk-a-very-secret-key"
USER, PASSWORD = "alice", "p@ss/w:rd+1"
BASIC = base64.b64encode(f"{USER}:{PASSWORD}".encode()).decode()
ASK = (Message("user", "Get a diamond."),)


def url_of(fake: FakeOpenAI) -> str:
    """Return the address with user and password in it."""
    place = urlsplit(fake.url).netloc
    return f"http://{USER}:{quote(PASSWORD, safe='')}@{place}/v1"


def forms() -> list[str]:
    """Return a text that a server may repeat."""
    found = [
        f"Basic {BASIC}",
        base64.b64encode(f"Basic {BASIC}".encode()).decode(),
        PASSWORD,
        quote(PASSWORD),
        quote(PASSWORD, safe="").lower(),
    ]
    found += [
        f"http://{USER}:{quote(PASSWORD, safe='')}@there/v1",
        KEY,
        quote(KEY),
        KEY.encode().hex(),
    ]
    for text in (KEY, f"x{KEY}y", f"Bearer {KEY}", f"ab{KEY}"):
        found += [
            base64.b64encode(text.encode()).decode(),
            base64.urlsafe_b64encode(text.encode()).decode(),
        ]
    return found


def leaks(text: str) -> list[str]:
    """Return the secrets that a text contains, in any form."""
    pieces = [PASSWORD, quote(PASSWORD), quote(PASSWORD, safe=""), KEY, KEY.encode().hex()]
    pieces += [quote(PASSWORD, safe="").lower()]
    for secret in (KEY, PASSWORD):
        for before in range(3):
            encoded = base64.b64encode(b"x" * before + secret.encode()).decode()
            pieces += [encoded[4:16], encoded[4:16].replace("+", "-").replace("/", "_")]
    # The user's name too, and the credentials encoded once more.
    pieces += [
        BASIC[:5],
        *(base64.b64encode(("x" * n + BASIC).encode()).decode()[4:16] for n in range(3)),
    ]
    return [piece for piece in pieces if piece in text]


def environment(fake: FakeOpenAI) -> dict[str, str]:
    return {"COMPATIBLE_BASE_URL": url_of(fake), "COMPATIBLE_API_KEY": KEY}


@pytest.mark.parametrize("status", [400, 401, 429, 500])
@pytest.mark.parametrize("form", forms())
def test_no_error_holds_a_secret(
    fake: FakeOpenAI, clock: FakeClock, status: int, form: str
) -> None:
    fake.will(fake.fails(status, f"you sent [{form}]"))
    model = open_model(
        "compatible:m", environment(fake), Connection(clock=clock, retries=RetryPolicy(attempts=1))
    )
    assert not leaks(repr(model))
    with pytest.raises(ModelError) as caught:
        model.answer(ASK, Sampling())
    told = "".join(traceback.format_exception(caught.value))
    assert not leaks(told)
    assert urlsplit(fake.url).netloc in told or "in 120 s" in told


@pytest.mark.parametrize("form", forms())
def test_no_answer_holds_a_secret(
    fake: FakeOpenAI, clock: FakeClock, tmp_path: Path, form: str
) -> None:
    fake.will(fake.says(f"// you sent [{form}] to me\nawait doNothing(bot);"))
    kept = Connection(clock=clock, cache=tmp_path / "answers", record=tmp_path / "model.jsonl")
    answer = open_model("compatible:m", environment(fake), kept).answer(ASK, Sampling())
    assert not leaks(answer.text)
    assert MASK in answer.text
    assert answer.text.endswith("to me\nawait doNothing(bot);")
    for file in tmp_path.rglob("*"):
        assert file.is_dir() or not leaks(file.read_text())


def test_the_server_itself_gets_key_user_and_password(fake: FakeOpenAI, clock: FakeClock) -> None:
    fake.will(fake.says("yes"))
    own = {"COMPATIBLE_BASE_URL": url_of(fake)}
    open_model("compatible:m", own, Connection(clock=clock)).answer(ASK, Sampling())
    assert fake.requests[-1].headers["authorization"] == f"Basic {BASIC}"


def test_libraries_log_no_password(
    fake: FakeOpenAI, clock: FakeClock, caplog: pytest.LogCaptureFixture
) -> None:
    fake.will(fake.fails(500, "no"))
    with caplog.at_level(logging.DEBUG), pytest.raises(ModelError):
        open_model(
            "compatible:m",
            {"COMPATIBLE_BASE_URL": url_of(fake)},
            Connection(clock=clock, retries=RetryPolicy(attempts=1)),
        ).answer(ASK, Sampling())
    assert caplog.text
    assert not leaks(caplog.text.replace("Authorization", ""))


@pytest.mark.parametrize(
    "behaviour",
    [
        pytest.param(FakeOpenAI.fails(400, forms()[0]), id="refused"),
        pytest.param(FakeOpenAI.hangs_up, id="hung up"),
        pytest.param(FakeOpenAI.garbles, id="garbled"),
        pytest.param(FakeOpenAI.says(" ".join(forms())), id="said"),
        pytest.param(
            FakeOpenAI.says(
                "```javascript\nthink(bot, '" + "'); think(bot, '".join(forms()) + "')\n```"
            ),
            id="thought",
        ),
    ],
)
def test_a_run_and_a_study_show_and_keep_no_secret(
    fake: FakeOpenAI,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    behaviour: object,
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, value in environment(fake).items():
        monkeypatch.setenv(name, value)
    clock = FakeClock()
    monkeypatch.setattr(SystemClock, "now", lambda _: clock.now())
    monkeypatch.setattr(SystemClock, "wait", lambda _, seconds: clock.wait(seconds))
    fake.will(behaviour)  # type: ignore[arg-type] # a behaviour
    options = ["--world", "scripted", "--model", "compatible:m"]
    run_command_line(["run", "sally-anne", "--condition", "3", *options, "--out", "run"])
    Path("study.yaml").write_text(
        "scenarios: [sally-anne]\nconditions: [3]\nmodels: ['compatible:m']\nworld: scripted\n"
    )
    run_command_line(["study", "study.yaml", "--out", "study", "--jobs", "1", "--record"])
    told = capfd.readouterr()
    assert fake.requests
    assert not leaks(told.out + told.err)
    for file in (each for each in tmp_path.rglob("*") if each.is_file()):
        assert not leaks(file.read_bytes().decode("latin-1")), file
    for store in tmp_path.rglob("*.bn"):
        with bn.Nest.read(store) as nest:
            assert not leaks(repr(nest.prompts()) + repr(nest.programs()))


@given(st.text(min_size=6, max_size=40), st.binary(max_size=5), st.binary(max_size=5))
def test_no_form_of_any_secret_is_left(secret: str, before: bytes, after: bytes) -> None:
    try:
        content = secret.encode()
    except UnicodeEncodeError:
        return
    whole = before + content + after
    for told in (
        f"a {secret} b",
        quote(secret),
        re.sub("%..", lambda found: found[0].lower(), quote(secret, safe="")),
        base64.b64encode(whole).decode(),
        base64.urlsafe_b64encode(whole).decode(),
        content.hex(),
        repr(secret),
    ):
        assert MASK in Secrets([secret]).masked_answer(told)


def test_short_keys_are_no_reason_to_change_answers() -> None:
    secrets = Secrets(["none"])
    assert secrets.masked_answer("there is none") == "there is none"
    assert secrets.masked("key none refused") == "key *** refused"


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("http://user:word@host:8000/v1", "http://host:8000/v1"),
        ("https://token@host/v1", "https://host/v1"),
        ("https://host/v1?api_key=abcdef&version=2", "https://host/v1?api_key=***&version=2"),
        ("http://us@er:wo@rd@host/v1", "http://host/v1"),
        ("http://[::1]:80/v1", "http://[::1]:80/v1"),
    ],
)
def test_addresses_are_shown_without_what_is_secret(url: str, shown: str) -> None:
    assert without_password(url) == shown


@pytest.mark.parametrize(
    "url", ["http://[::1", "http://host:port/v1", "secretword", "http://:secret@/v1"]
)
def test_what_is_no_address_is_refused_without_being_shown(url: str) -> None:
    with pytest.raises(
        ModelError, match="COMPATIBLE_BASE_URL is not the address of a server"
    ) as caught:
        open_model("compatible:m", {"COMPATIBLE_BASE_URL": url}, Connection())
    assert url not in "".join(traceback.format_exception(caught.value))
