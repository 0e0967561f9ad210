"""Questions that the page's server cannot answer: status 400 and one line, whatever they ask."""

import asyncio
import json
from typing import Any
from urllib.parse import quote

import pytest

from beliefnest.viewer.serving.host import Host
from beliefnest.viewer.serving.routes import page_app

ODD = ["x", "-1", "1e9", "9" * 5000, "", "\u202e", "nan", "\0"]
PLACE = "run=0&on=0&path=/&tick=0"


def answered(path: str, query: str) -> tuple[int, str]:
    """Status and text of an answer of a server that shows nothing."""
    sent: list[dict[str, Any]] = []

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    def open_nothing(_: object) -> Any:
        raise AssertionError("there is nothing to open")

    scope = {
        "type": "http",
        "method": "GET",
        "path": path,
        "query_string": query.encode(),
        "headers": [(b"host", b"localhost:1")],
    }
    app = page_app(Host(lambda: [], open_nothing), {"localhost:1"}, None)
    asyncio.run(app(scope, receive, send))
    body = b"".join(message.get("body", b"") for message in sent[1:])
    return sent[0]["status"], body.decode()


@pytest.mark.parametrize("odd", ODD, ids=range(len(ODD)))
@pytest.mark.parametrize(
    ("path", "query"),
    [
        ("/api/live", "from=?"),
        ("/api/explain", "run=?&on=0&path=/&tick=0&thing=agent-0"),
        ("/api/explain", "run=0&on=?&path=/&tick=0&thing=agent-0"),
        ("/api/explain", "run=0&on=0&path=?&tick=0&thing=agent-0"),
        ("/api/explain", "run=0&on=0&path=/&tick=?&thing=agent-0"),
        ("/api/explain", f"{PLACE}&thing=?"),
        ("/api/explain", f"{PLACE}&thing=agent-?"),
        ("/api/explain", PLACE),
        ("/api/look", f"{PLACE}&viewer=?&thing=block-0"),
        ("/api/look", f"{PLACE}&viewer=ann&thing=container-?"),
        ("/api/sight", f"{PLACE}&viewer=?"),
        ("/api/sight", PLACE),
        ("/api/deepen", "run=0&on=0&path=?"),
        ("/api/deepen", ""),
    ],
)
def test_wrong_questions_are_told_so(path: str, query: str, odd: str) -> None:
    status, text = answered(path, query.replace("?", quote(odd)))
    assert status == 400
    (error,) = json.loads(text).values()
    assert "\n" not in error
