"""The HTTP client that models are asked through: what a server sends is counted, byte by byte.

A line of a stream, a comment in it or the text of an error is no part of an answer, so that no
limit of answers would meet it, and yet it has to be held in memory.
"""

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from beliefnest.errors import ModelError

if TYPE_CHECKING:  # An extra, imported when a provider is asked.
    import httpx2

__all__ = ["TooManyBytesError", "bounded_client"]

_SECONDS_TO_CONNECT = 5.0


class TooManyBytesError(ModelError):
    """A server sends more than an answer can take."""


def bounded_client(
    seconds: float, longest: int, user: tuple[str, str] | None = None
) -> "httpx2.AsyncClient":
    """Return a client that gives up a response of more than `longest` bytes; the caller closes it.

    Args:
        seconds: What one step of a request may take.
        longest: Bytes of a response, as they are sent. Responses are asked for uncompressed, and
            compressed ones refused: a few bytes of them may stand for any number.
        user: User and password for the server, if it wants any.
    """
    import httpx2

    async def bound(response: httpx2.Response) -> None:
        coding = response.headers.get("content-encoding", "identity")
        if coding != "identity":
            raise TooManyBytesError(f"the answer is compressed ({coding:.20}), which was not asked")
        stream = response.stream
        if isinstance(stream, httpx2.AsyncByteStream):
            response.stream = Bounded(stream)

    class Bounded(httpx2.AsyncByteStream):
        """A stream that is counted."""

        def __init__(self, inner: httpx2.AsyncByteStream) -> None:
            self._inner = inner

        async def __aiter__(self) -> AsyncIterator[bytes]:
            received = 0
            async for piece in self._inner:
                received += len(piece)
                if received > longest:
                    raise TooManyBytesError(f"the server sent more than {longest:,} bytes")
                yield piece

        async def aclose(self) -> None:
            await self._inner.aclose()

    return httpx2.AsyncClient(
        auth=user,
        timeout=httpx2.Timeout(seconds, connect=min(seconds, _SECONDS_TO_CONNECT)),
        headers={"accept-encoding": "identity"},
        event_hooks={"response": [bound]},
        follow_redirects=True,
    )
