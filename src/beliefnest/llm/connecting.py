"""HTTP client for models, which limits the bytes of every response.

Limits on the length of answers are not enough: events of a stream, comments in it and texts of
errors are not part of an answer, but must be held in memory.
"""

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from beliefnest.errors import ModelError

if TYPE_CHECKING:  # An extra, imported when a provider is asked.
    import httpx2

__all__ = ["TooManyBytesError", "bounded_client"]

_SECONDS_TO_CONNECT = 5.0


class TooManyBytesError(ModelError):
    """A server sent more bytes than any answer needs."""


def bounded_client(
    seconds: float, longest: int, user: tuple[str, str] | None = None
) -> "httpx2.AsyncClient":
    """Return a client that aborts responses of more than `longest` bytes; the caller closes it.

    Args:
        seconds: Timeout of one step of a request.
        longest: Greatest number of bytes of a response. The client asks for uncompressed
            responses and refuses others: a few compressed bytes can expand to any number.
        user: User and password for the server, if it needs them.
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
            response.stream = Bounded(stream)

    class Bounded(httpx2.AsyncByteStream):
        """Stream that counts its bytes."""

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
