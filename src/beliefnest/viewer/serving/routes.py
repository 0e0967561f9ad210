"""Routes of the server: the page, updates, and answers to the page's queries."""

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Callable, Collection, Mapping
from contextlib import asynccontextmanager, suppress
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response, StreamingResponse
from starlette.routing import Route

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.viewer.page.html import page_html
from beliefnest.viewer.serving.guard import Guard
from beliefnest.viewer.serving.host import Host
from beliefnest.world.texts import quoted, visible_json

_PAUSE = 0.025
"""Seconds between checks for updates; a change should be on the page within 0.1 s."""

_DISCOVERY = 20
"""Number of checks between two searches for new runs."""

_HEARTBEAT = 15.0
_AFTER_FAULT = 2.0
_LOG = logging.getLogger("uvicorn.error")


class _News:
    """Notifier of requests that wait for updates, or for the end of the server.

    Args:
        host: Host whose updates are checked.
        is_ending: True if the server has been told to stop.
    """

    def __init__(self, host: Host, is_ending: Callable[[], bool]) -> None:
        self._host, self.is_ending = host, is_ending
        self._woken = asyncio.Condition()

    async def run(self) -> None:
        """Check for updates until the server is told to stop."""
        looks, count = 0, len(self._host.told)
        while not self.is_ending():
            try:
                if looks % _DISCOVERY == 0:
                    await run_in_threadpool(self._host.discover)
                looks += 1
                now = await run_in_threadpool(self._host.follow)
            except BeliefNestError as error:
                _LOG.error("%s", error)
                await asyncio.sleep(_AFTER_FAULT)
                continue
            if now != count:
                count = now
                await self._wake()
            await asyncio.sleep(_PAUSE)
        await self._wake()

    async def _wake(self) -> None:
        async with self._woken:
            self._woken.notify_all()

    async def after(self, number: int) -> bool:
        """Wait for more than `number` updates; return False after a while or at the end."""
        async with self._woken:
            with suppress(TimeoutError):
                async with asyncio.timeout(_HEARTBEAT):
                    await self._woken.wait_for(
                        lambda: len(self._host.told) > number or self.is_ending()
                    )
                    return len(self._host.told) > number
        return False


def page_app(
    runs: Host,
    addresses: Collection[str],
    token: str | None,
    is_ending: Callable[[], bool] = lambda: False,
) -> Starlette:
    """Return the application.

    Args:
        runs: Host of the runs.
        addresses: Names and ports by which the server may be addressed.
        token: Token that requests must have; None for no token.
        is_ending: Returns True when the server has been told to stop; listening pages are then
            released.
    """
    news: list[_News] = []

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        news.append(_News(runs, is_ending))
        looking = asyncio.create_task(news[0].run())
        try:
            yield
        finally:
            looking.cancel()
            with suppress(asyncio.CancelledError):
                await looking
            await run_in_threadpool(runs.close)

    async def live(request: Request) -> Response:
        first = _number(request.query_params, "from")
        return StreamingResponse(_updates(runs, news[0], first), media_type="text/event-stream")

    routes = [
        Route("/", lambda request: _page(runs)),
        Route("/api/live", live),
        Route("/api/explain", _answer(lambda q: runs.explain(*_moment(q), _text(q, "thing")))),
        Route(
            "/api/look",
            _answer(lambda q: _told(runs.look(*_moment(q), _text(q, "viewer"), _text(q, "thing")))),
        ),
        Route("/api/sight", _answer(lambda q: _told(runs.sight(*_moment(q), _text(q, "viewer"))))),
        Route("/api/deepen", _answer(lambda q: _told(runs.deepen(*_place(q))))),
    ]
    guard = Middleware(Guard, hosts=addresses, token=token)
    return Starlette(
        routes=routes,
        middleware=[guard],
        exception_handlers={BeliefNestError: _refused},
        lifespan=lifespan,
    )


def _refused(_: Request, error: Exception) -> Response:
    """Return a response that says in one line why a query is refused."""
    return _answered({"error": str(error)}, 400)


def _answered(content: object, status: int = 200) -> Response:
    return Response(_json(content), status, media_type="application/json")


def _json(content: object) -> str:
    return visible_json(json.dumps(content, separators=(",", ":"), ensure_ascii=False))


def _page(host: Host) -> Response:
    updates = list(host.told)
    title = next((u["head"]["title"] for _, u in updates if "head" in u), "BeliefNest")
    content = {"updates": updates, "count": len(updates), "first": {}}
    return HTMLResponse(page_html(title, content, served=True))


async def _updates(host: Host, news: _News, first: int) -> AsyncIterator[str]:
    """Yield the updates from number `first` on, as server-sent events."""
    number = first
    while not news.is_ending():
        for run, update in host.told[number:]:
            number += 1
            message = _json({"run": run, "update": update})
            yield f"id: {number}\ndata: {message}\n\n"
        if not await news.after(number):
            yield ": still here\n\n"


def _answer(ask: Callable[[Mapping[str, str]], Any]) -> Callable[[Request], Response]:
    """Return a route that computes its answer in a thread."""

    def answer(request: Request) -> Response:
        return _answered(ask(request.query_params))

    return answer


def _told(answer: object) -> dict[str, object]:
    return {"answer": answer}


def _place(query: Mapping[str, str]) -> tuple[int, int, str]:
    return _number(query, "run"), _number(query, "on"), _text(query, "path")


def _moment(query: Mapping[str, str]) -> tuple[int, int, str, int]:
    return (*_place(query), _number(query, "tick"))


def _text(query: Mapping[str, str], name: str) -> str:
    if name not in query:
        raise InputError(f"the query lacks {name}")
    return query[name]


def _number(query: Mapping[str, str], name: str) -> int:
    text = query.get(name, "0")
    if not (text.isascii() and text.isdecimal()) or len(text) > 12:
        raise InputError(f"{name} is {quoted(text)}; give a whole number")
    return int(text)
