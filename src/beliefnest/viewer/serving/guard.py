"""Guard that refuses requests from other sites, for other host names, and without the token."""

import hmac
from collections.abc import Collection
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_COOKIE = "beliefnest"

_HEADERS = (
    (b"x-frame-options", b"DENY"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-store"),
    (b"cross-origin-resource-policy", b"same-origin"),
)


class Guard:
    """Middleware that refuses requests that do not come from the page itself.

    A host name of a stranger's site that resolves to this machine (DNS rebinding) is not among
    `hosts`. For a request that another site makes, the browser names that site.

    Args:
        app: The guarded application.
        hosts: Allowed values of the header `Host`.
        token: Required token, given by the query `token` or by the cookie for which it was
            exchanged; None for no token.
    """

    def __init__(self, app: ASGIApp, hosts: Collection[str], token: str | None) -> None:
        self._app, self._hosts, self._token = app, frozenset(hosts), token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it with advice."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = {
            name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]
        }
        problem = self._problem(scope, headers)
        if problem is not None:
            await PlainTextResponse(problem, 403)(scope, receive, send)
            return
        token = self._given(scope)

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *_HEADERS]
                if token is not None:
                    cookie = f"{_COOKIE}={token}; HttpOnly; SameSite=Strict; Path=/"
                    message["headers"].append((b"set-cookie", cookie.encode("latin-1")))
            await send(message)

        await self._app(scope, receive, sending)

    def _problem(self, scope: Scope, headers: dict[str, str]) -> str | None:
        if headers.get("host", "") not in self._hosts:
            return "this host name is not allowed; use the address that the server printed"
        if headers.get("sec-fetch-site", "none") not in {"none", "same-origin"}:
            return "requests from other sites are refused; use the address that the server printed"
        if self._token is None:
            return None
        token = self._given(scope) or self._kept(headers)
        if token is None or not _same(token, self._token):
            return "the token is missing or wrong; use the address that the server printed"
        return None

    def _given(self, scope: Scope) -> str | None:
        if self._token is None:
            return None
        tokens = parse_qs(scope["query_string"].decode("latin-1")).get("token")
        return tokens[0] if tokens and _same(tokens[0], self._token) else None

    def _kept(self, headers: dict[str, str]) -> str | None:
        try:
            cookies = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            return None
        return cookies[_COOKIE].value if _COOKIE in cookies else None


def _same(one: str, other: str) -> bool:
    """Return True if two texts are equal; the time taken does not reveal how far they agree."""
    return hmac.compare_digest(one.encode(), other.encode())
