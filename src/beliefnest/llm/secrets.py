"""Keys and passwords of a model's server, and how they are kept out of all that is shown or kept.

A server may repeat a key in an answer or an error, as it was sent or encoded. `Secrets.masked`
replaces each of these forms. A model of a provider passes all that comes from its server through
it (`llm/remote.py`), so that recordings, caches, tables and pages never hold a secret.
"""

import base64
import html
import json
import re
from collections.abc import Iterable, Iterator
from urllib.parse import parse_qsl, quote, quote_plus, unquote, urlsplit, urlunsplit

__all__ = ["MASK", "Secrets", "secrets_in", "without_password"]

MASK = "***"

_SHORTEST_IN_ANSWERS = 6
"""Characters of a secret that is masked in answers too: shorter ones are in many words."""

_BASE64 = "[A-Za-z0-9+/_-]"

_SECRET_PARAMETER = re.compile(r"key|token|secret|pass|pwd|auth|sig|cred|code", re.IGNORECASE)


class Secrets:
    """Texts that nothing may show.

    Args:
        values: The texts; empty ones are left out.
    """

    def __init__(self, values: Iterable[str]) -> None:
        known = sorted({value for value in values if value}, key=len, reverse=True)
        self._everywhere = _pattern(known)
        self._in_answers = _pattern(v for v in known if len(v) >= _SHORTEST_IN_ANSWERS)

    def __repr__(self) -> str:
        return "<secrets>"

    def masked(self, text: str) -> str:
        """Return a message with `***` in place of each secret."""
        return _replaced(self._everywhere, text)

    def masked_answer(self, text: str) -> str:
        """Return an answer with `***` in place of each secret of at least 6 characters."""
        return _replaced(self._in_answers, text)


def secrets_in(url: str) -> list[str]:
    """Return the secrets in a URL: its password, or else its user name, and keys in its query."""
    parts = urlsplit(url)
    query = (value for name, value in parse_qsl(parts.query) if _SECRET_PARAMETER.search(name))
    found = [parts.password or parts.username or "", *query]
    return [form for each in found for form in (each, unquote(each))]


def without_password(url: str) -> str:
    """Return a URL as it may be shown: without user, password and the keys in its query."""
    parts = urlsplit(url)
    query = Secrets(secrets_in(url)).masked(parts.query)
    return urlunsplit(parts._replace(netloc=parts.netloc.rpartition("@")[2], query=query))


def _replaced(pattern: "re.Pattern[str] | None", text: str) -> str:
    return text if pattern is None else pattern.sub(MASK, text)


def _pattern(secrets: Iterable[str]) -> "re.Pattern[str] | None":
    forms = {form for secret in secrets for form in _forms(secret)}
    # The longest first: a secret may begin as another one does.
    ordered = sorted(forms, key=lambda form: (-len(form), form))
    return re.compile("|".join(ordered)) if ordered else None


def _forms(secret: str) -> Iterator[str]:
    """Yield regular expressions of all forms in which a server may repeat a secret."""
    escapes = (json.dumps(secret)[1:-1], repr(secret)[1:-1], html.escape(secret))
    for plain in (secret, *escapes):
        yield re.escape(plain)
    for encoded in (quote(secret), quote(secret, safe=""), quote_plus(secret)):
        yield re.sub(r"%[0-9A-F]{2}", lambda found: f"(?i:{found[0]})", re.escape(encoded))
    content = secret.encode(errors="surrogatepass")
    yield f"(?i:{content.hex()})"
    for before in range(3):
        core = _base64_core(content, before)
        if core:
            for alphabet in (core, core.replace("+", "-").replace("/", "_")):
                yield f"{_BASE64}{{0,2}}{re.escape(alphabet)}{_BASE64}*={{0,2}}"


def _base64_core(content: bytes, before: int) -> str:
    """Return what base64 always makes of bytes that stand after `before` others, modulo 3."""
    encoded = base64.b64encode(bytes(before) + content).decode()
    whole = (before + len(content)) * 8 // 6
    return encoded[-(-before * 8 // 6) : whole]
