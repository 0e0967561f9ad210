"""Server of the editor of scenario files: its page, the scene of a text, and saving."""

import json
from collections.abc import Callable, Collection
from typing import Any, Protocol

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.viewer.page.html import page_html
from beliefnest.viewer.serving.guard import Guard
from beliefnest.world.texts import visible_json

_LARGEST = 8 * 2**20
"""Greatest size of a request in bytes."""


class Editor(Protocol):
    """Editor of one scenario file."""

    @property
    def title(self) -> str:
        """Name of the file."""

    def begin(self) -> dict[str, Any]:
        """Return the text of the file, and what the page needs before the first edit."""

    def shown(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the text after edits, with its scene or what is wrong with it."""

    def save(self, request: dict[str, Any]) -> dict[str, Any]:
        """Write a text into the file."""


def editor_app(editor: Editor, addresses: Collection[str], token: str | None) -> Starlette:
    """Return the application.

    Args:
        editor: Editor of the file.
        addresses: Names and ports by which the server may be addressed.
        token: Token that requests must have; None for no token.
    """

    async def page(_: Request) -> Response:
        begun = await run_in_threadpool(editor.begin)
        return HTMLResponse(page_html(editor.title, begun, served=True, name="editor"))

    routes = [
        Route("/", page),
        Route("/api/scene", _answering(editor.shown), methods=["POST"]),
        Route("/api/save", _answering(editor.save), methods=["POST"]),
    ]
    guard = Middleware(Guard, hosts=addresses, token=token)
    return Starlette(
        routes=routes, middleware=[guard], exception_handlers={BeliefNestError: _refused}
    )


def _answering(answer: Callable[[dict[str, Any]], dict[str, Any]]) -> Callable[[Request], Any]:
    """Return a route that answers a JSON object with another."""

    async def answered(request: Request) -> Response:
        content = await _content(request)
        return _json(await run_in_threadpool(answer, content))

    return answered


async def _content(request: Request) -> dict[str, Any]:
    """Return the JSON object of a request.

    Other sites can send forms and plain texts without asking the browser's permission, but no
    JSON.

    Raises:
        InputError: It is no JSON object, or too large.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip()
    if kind != "application/json":
        raise InputError("the request is not application/json; use the page of the editor")
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > _LARGEST:
            raise InputError(f"the request has more than {_LARGEST} bytes")
    try:
        content = json.loads(body)
    except (ValueError, RecursionError):
        raise InputError("the request is no JSON") from None
    if not isinstance(content, dict):
        raise InputError("the request is no JSON object")
    return content


def _refused(_: Request, error: Exception) -> Response:
    """Return a response that says in one line why a request is refused."""
    return _json({"problem": str(error)}, 400)


def _json(content: object, status: int = 200) -> Response:
    text = visible_json(json.dumps(content, separators=(",", ":"), ensure_ascii=False))
    return Response(text, status, media_type="application/json")
