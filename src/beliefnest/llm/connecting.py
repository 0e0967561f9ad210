"""HTTP client for models, which limits the bytes of every response.

Limits on the length of answers are not enough: events of a stream, comments in it and texts of
errors are not part of an answer, but must be held in memory.
"""

import json
import os
import re
from collections.abc import AsyncIterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from beliefnest.errors import ModelError
from beliefnest.llm.providers import Endpoint
from beliefnest.llm.routes import SECONDS_TO_CONNECT, is_loopback

if TYPE_CHECKING:  # An extra, imported when a provider is asked.
    import ssl

    import httpx2

_END = re.compile(rb"(?:^|[\r\n])data: ?\[DONE\]")
"""Mark with which a stream of OpenAI's protocol ends; within its JSON no line ends."""
_LONGEST_END = 16


class TooManyBytesError(ModelError):
    """A server sent more bytes than any answer needs."""


@dataclass
class ByteCount:
    """Bytes of a response since the last text in it.

    Attributes:
        most: Greatest number of bytes.
        received: Number of bytes so far.
        ended: True after the mark of the end of a stream.
    """

    most: int
    received: int = 0
    ended: bool = False
    _last: bytes = b"\n"

    def add(self, piece: bytes) -> None:
        """Count a piece of the response.

        Raises:
            TooManyBytesError: There are too many.
        """
        self.received += len(piece)
        if self.received > self.most:
            raise TooManyBytesError(f"the server sent more than {self.most:,} bytes without text")
        self.ended = self.ended or _END.search(self._last + piece) is not None
        self._last = (self._last + piece)[-_LONGEST_END:]

    def restart(self) -> None:
        """Count from 0 again."""
        self.received = 0


def bounded_client(endpoint: Endpoint, seconds: float, count: ByteCount) -> "httpx2.AsyncClient":
    """Return a client that aborts responses of too many bytes; the caller closes it.

    The client asks for uncompressed responses and refuses others: a few compressed bytes can
    expand to any number. It reads proxies and certificates from the environment, but asks servers
    on this machine directly.

    Args:
        endpoint: The server.
        seconds: Timeout of one step of a request after the connection.
        count: Count of bytes.
    """
    import httpx2

    async def bound(response: httpx2.Response) -> None:
        coding = response.headers.get("content-encoding", "identity")
        if coding != "identity":
            raise TooManyBytesError(
                f"the answer is compressed ({coding:.20}), which was not requested"
            )
        stream = response.stream
        if isinstance(stream, httpx2.AsyncByteStream):
            kind = response.headers.get("content-type", "")
            whole = response.is_success and kind.startswith("application/json")
            response.stream = Bounded(stream, whole)

    class Bounded(httpx2.AsyncByteStream):
        """Stream that counts its bytes; the events of an answer that came whole."""

        def __init__(self, inner: httpx2.AsyncByteStream, whole: bool) -> None:
            self._inner, self._whole = inner, whole

        async def __aiter__(self) -> AsyncIterator[bytes]:
            body = b""
            async for piece in self._inner:
                count.add(piece)
                if self._whole:
                    body += piece
                else:
                    yield piece
            if self._whole:
                events = _events(body)
                count.add(events)
                yield events

        async def aclose(self) -> None:
            await self._inner.aclose()

    is_near = is_loopback(endpoint.url)
    # Certificates of servers on this machine may be the user's own.
    is_plain = is_near and endpoint.url.startswith("http:")
    named = (None if is_plain else os.environ.get(f"SSL_CERT_{kind}") for kind in ("FILE", "DIR"))
    return httpx2.AsyncClient(
        auth=endpoint.user,
        timeout=httpx2.Timeout(seconds, connect=SECONDS_TO_CONNECT),
        headers={"accept-encoding": "identity"},
        event_hooks={"response": [bound]},
        follow_redirects=True,
        verify=_trusted(*named),
        trust_env=not is_near,
    )


@cache
def _trusted(file: str | None, folder: str | None) -> "ssl.SSLContext":
    """Return the certificates to trust: those that variables name, or the system's. Read once."""
    import httpx2

    return httpx2.create_ssl_context(trust_env=bool(file or folder))


def _events(body: bytes) -> bytes:
    """Return a whole answer of OpenAI's protocol as its stream, and any other body as it is.

    Servers that cannot stream send such answers.
    """
    try:
        answer = json.loads(body)
    except ValueError:
        return body
    match answer:
        case {"choices": [{"message": {**message}, **choice}, *_]}:
            made: Any = message.get("tool_calls") or ()
            calls = [{"index": n, **call} for n, call in enumerate(made)]
            choices = [{**choice, "delta": {**message, "tool_calls": calls or None}}]
            chunk = {**answer, "object": "chat.completion.chunk", "choices": choices}
            return f"data: {json.dumps(chunk)}\n\ndata: [DONE]\n\n".encode()
    return body
