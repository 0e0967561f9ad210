"""A local server that speaks OpenAI's chat-completions protocol, faults included."""

import contextlib
import json
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest


@dataclass
class Handled:
    """Request that the server got."""

    path: str
    headers: dict[str, str]
    body: dict


Behaviour = Callable[["Handler"], None]


def says(text, **end) -> Behaviour:
    def behave(handler: "Handler") -> None:
        handler.start_stream()
        for start in range(0, len(text), 20):
            handler.send_chunk(delta={"role": "assistant", "content": text[start : start + 20]})
        handler.end_stream(**end)

    return behave


def says_as(provider, text) -> Behaviour:
    """Return an answer in the stream of another provider's protocol."""
    events = {"anthropic": _anthropic_events, "google": _google_events}[provider](text)

    def behave(handler: "Handler") -> None:
        handler.start_stream()
        for event in events:
            kind = f"event: {event['type']}\n" if "type" in event else ""
            handler.wfile.write(f"{kind}data: {json.dumps(event)}\n\n".encode())

    return behave


def _anthropic_events(text) -> list[dict]:
    message = {"id": "x", "type": "message", "role": "assistant", "model": "m", "content": []}
    message |= {"stop_reason": None, "stop_sequence": None}
    message["usage"] = {"input_tokens": 120, "output_tokens": 1}
    ended = {"stop_reason": "end_turn", "stop_sequence": None}
    return [
        {"type": "message_start", "message": message},
        {
            "type": "content_block_start",
            "index": 0,
            "content_block": {"type": "text", "text": ""},
        },
        {
            "type": "content_block_delta",
            "index": 0,
            "delta": {"type": "text_delta", "text": text},
        },
        {"type": "content_block_stop", "index": 0},
        {"type": "message_delta", "delta": ended, "usage": {"output_tokens": 30}},
        {"type": "message_stop"},
    ]


def _google_events(text) -> list[dict]:
    content = {"role": "model", "parts": [{"text": text}]}
    counts = {"promptTokenCount": 120, "candidatesTokenCount": 30, "totalTokenCount": 150}
    return [
        {
            "candidates": [{"content": content, "finishReason": "STOP", "index": 0}],
            "usageMetadata": counts,
            "modelVersion": "gemini-2.5-flash",
        }
    ]


def fails(status, message="no", headers=(), code=None) -> Behaviour:
    def behave(handler: "Handler") -> None:
        body = json.dumps({"error": {"message": message, "type": "error", "code": code}}).encode()
        handler.send_response(status)
        for name, value in headers:
            handler.send_header(name, value)
        handler.send_header("Content-Type", "application/json")
        handler.send_header("Content-Length", str(len(body)))
        handler.end_headers()
        handler.wfile.write(body)

    return behave


def hangs_up(handler: "Handler") -> None:
    """Close the connection without a word."""


def drops_halfway(handler: "Handler") -> None:
    handler.send_response(200)
    handler.send_header("Content-Type", "text/event-stream")
    handler.send_header("Content-Length", "100000")
    handler.end_headers()
    handler.send_chunk(delta={"role": "assistant", "content": "await"})


def refuses(handler: "Handler") -> None:
    handler.start_stream()
    handler.send_chunk(delta={"role": "assistant", "refusal": "I will not steal diamonds."})
    handler.end_stream()


def floods(handler: "Handler") -> None:
    """10 MB, in pieces."""
    handler.start_stream()
    for _ in range(1000):
        handler.send_chunk(delta={"role": "assistant", "content": "x" * 10_000})
    handler.end_stream()


def drips(handler: "Handler") -> None:
    """One letter after the other, until the client has gone."""
    handler.start_stream()
    for _ in range(100_000):
        handler.send_chunk(delta={"role": "assistant", "content": "x"})


def drips_slowly(handler: "Handler", letters: int, pause: float) -> None:
    """One letter after the other, with a pause after each."""
    handler.start_stream()
    for _ in range(letters):
        handler.send_chunk(delta={"role": "assistant", "content": "x"})
        handler.fake.closing.wait(pause)
    handler.end_stream()


def says_nothing(handler: "Handler") -> None:
    """Keep the connection open until the test ends."""
    handler.fake.closing.wait()


def answers_with_a_page(handler: "Handler") -> None:
    """Answer with a page, as a proxy may."""
    page = b"<html>Welcome</html>"
    handler.send_response(200)
    handler.send_header("Content-Type", "text/html")
    handler.send_header("Content-Length", str(len(page)))
    handler.end_headers()
    handler.wfile.write(page)


def answers_whole(body: bytes) -> Behaviour:
    """Return an answer in one body, as servers give that cannot stream."""

    def behave(handler: "Handler") -> None:
        handler.send_response(200)
        handler.send_header("Content-Type", "application/json")
        handler.send_header("Content-Length", str(len(body)))
        handler.end_headers()
        handler.wfile.write(body)

    return behave


def completion(message, reason) -> bytes:
    choice = {"index": 0, "message": message, "finish_reason": reason}
    counts = {"prompt_tokens": 12, "completion_tokens": 3, "total_tokens": 15}
    body = {"id": "x", "object": "chat.completion", "created": 1, "model": "m"}
    return json.dumps({**body, "choices": [choice], "usage": counts}).encode()


def garbles(handler: "Handler") -> None:
    handler.start_stream()
    handler.wfile.write(b'data: {"id": "x", "choi\n\n')


def fails_halfway(handler: "Handler") -> None:
    handler.start_stream()
    handler.send_chunk(delta={"role": "assistant", "content": "await"})
    error = {"message": "overloaded", "type": "server_error", "code": "500"}
    handler.wfile.write(f"data: {json.dumps({'error': error})}\n\n".encode())


@dataclass
class FakeOpenAI:
    """Each request is answered by the next behaviour; the last one answers all further ones."""

    url: str = ""
    requests: list[Handled] = field(default_factory=list)
    behaviours: list[Behaviour] = field(default_factory=list)
    closing: threading.Event = field(default_factory=threading.Event)

    says = staticmethod(says)
    says_as = staticmethod(says_as)
    fails = staticmethod(fails)
    hangs_up = staticmethod(hangs_up)
    drops_halfway = staticmethod(drops_halfway)
    refuses = staticmethod(refuses)
    floods = staticmethod(floods)
    answers_with_a_page = staticmethod(answers_with_a_page)
    answers_whole = staticmethod(answers_whole)
    completion = staticmethod(completion)
    garbles = staticmethod(garbles)
    fails_halfway = staticmethod(fails_halfway)
    drips = staticmethod(drips)
    drips_slowly = staticmethod(drips_slowly)
    says_nothing = staticmethod(says_nothing)

    def will(self, *behaviours: Behaviour) -> None:
        self.behaviours[:] = behaviours


class Handler(BaseHTTPRequestHandler):
    fake: FakeOpenAI

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        fake = self.fake
        fake.requests.append(
            Handled(self.path, {name.lower(): value for name, value in self.headers.items()}, body)
        )
        index = min(len(fake.requests), len(fake.behaviours)) - 1
        # A client that gives up closes its end; that is the point of some tests.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            fake.behaviours[index](self)
        self.close_connection = True

    def log_message(self, format, *args) -> None:
        pass

    def start_stream(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()

    def send_chunk(self, **choice) -> None:
        usage = choice.pop("usage", None)
        chunk = {
            "id": "x",
            "object": "chat.completion.chunk",
            "created": 1,
            "model": self.fake.requests[-1].body["model"],
            "choices": [] if usage else [{"index": 0, "finish_reason": None, **choice}],
            "usage": usage,
        }
        self.wfile.write(f"data: {json.dumps(chunk)}\n\n".encode())
        self.wfile.flush()

    def end_stream(self, reason="stop", usage=True) -> None:
        self.send_chunk(delta={}, finish_reason=reason)
        if usage:
            counts = {"prompt_tokens": 120, "completion_tokens": 30, "total_tokens": 150}
            self.send_chunk(usage=counts)
        self.wfile.write(b"data: [DONE]\n\n")


@pytest.fixture
def fake() -> Iterator[FakeOpenAI]:
    with serving() as served:
        yield served


@pytest.fixture(scope="module")
def neighbour() -> Iterator[FakeOpenAI]:
    """One server for all examples of a property."""
    with serving() as served:
        yield served


@contextlib.contextmanager
def serving() -> Iterator[FakeOpenAI]:
    served = FakeOpenAI()

    class Bound(Handler):
        pass

    Bound.fake = served
    server = ThreadingHTTPServer(("127.0.0.1", 0), Bound)
    server.daemon_threads = True
    served.url = f"http://127.0.0.1:{server.server_port}/v1"
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield served
    finally:
        served.closing.set()
        server.shutdown()
        server.server_close()
        thread.join()


class FakeClock:
    """Time that passes when somebody waits."""

    def __init__(self) -> None:
        self.time = 0.0
        self.waits: list[float] = []

    def now(self) -> float:
        return self.time

    def wait(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.time += seconds


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()
