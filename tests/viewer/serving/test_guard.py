"""Requests that the page's server answers, and requests that it refuses."""

import asyncio
from typing import Any

import pytest
from starlette.responses import PlainTextResponse

from beliefnest.viewer.serving.guard import Guard

HOSTS = {"127.0.0.1:8642", "localhost:8642"}
ME = {"host": "127.0.0.1:8642"}


def ask(token: str | None, headers: dict[str, str], query: str = "") -> tuple[int, dict[str, str]]:
    """Status and headers of what is answered."""
    sent: list[dict[str, Any]] = []

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    scope = {
        "type": "http",
        "method": "GET",
        "path": "/",
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    guard = Guard(PlainTextResponse("the page"), HOSTS, token)
    asyncio.run(guard(scope, receive, send))
    told = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    return sent[0]["status"], told


def test_the_page_itself_is_answered_and_may_not_be_framed_or_kept():
    status, headers = ask(None, ME)
    assert status == 200
    assert headers["x-frame-options"] == "DENY"
    assert headers["cache-control"] == "no-store"


@pytest.mark.parametrize("host", ["evil.example:8642", "127.0.0.1", "127.0.0.1:80", ""])
def test_a_name_that_is_not_the_servers_own_is_turned_away(host):
    assert ask(None, {"host": host})[0] == 403


def test_requests_of_other_sites_are_turned_away():
    assert ask(None, ME | {"sec-fetch-site": "cross-site"})[0] == 403
    assert ask(None, ME | {"sec-fetch-site": "same-site"})[0] == 403
    assert ask(None, ME | {"sec-fetch-site": "same-origin"})[0] == 200


def test_a_token_is_asked_for_and_exchanged_for_a_cookie():
    assert ask("secret", ME)[0] == 403
    assert ask("secret", ME, "token=other")[0] == 403
    assert ask("secret", ME | {"cookie": "beliefnest=other"})[0] == 403
    status, headers = ask("secret", ME, "token=secret")
    assert status == 200
    assert headers["set-cookie"] == "beliefnest=secret; HttpOnly; SameSite=Strict; Path=/"
    assert ask("secret", ME | {"cookie": "a=b; beliefnest=secret"})[0] == 200
