"""Masking of keys and passwords of a model's server in all output and all files.

A server may repeat a key in an answer or an error, as it was sent or encoded. `Secrets.masked`
replaces each of these forms. Models of providers mask everything that comes from their server
(`llm/remote.py`), so that recordings, caches, tables and pages never hold a secret.
"""

import base64
import html
import json
import re
from collections.abc import Iterable, Iterator
from urllib.parse import parse_qsl, quote, quote_plus, unquote, urlsplit, urlunsplit

MASK = "***"

_SHORTEST_IN_ANSWERS = 6
"""Shortest secret that is masked in answers too, in characters. Shorter ones are parts of many
words."""

_BASE64 = "[A-Za-z0-9+/_-]"

_SECRET_PARAMETER = re.compile(r"key|token|secret|pass|pwd|auth|sig|cred|code", re.IGNORECASE)


class Secrets:
    """Texts that must not be shown.

    Args:
        values: The texts; empty ones are ignored.
    """

    def __init__(self, values: Iterable[str]) -> None:
        values_by_length = sorted({value for value in values if value}, key=len, reverse=True)
        self._everywhere = _pattern(values_by_length)
        self._in_answers = _pattern(v for v in values_by_length if len(v) >= _SHORTEST_IN_ANSWERS)

    def __repr__(self) -> str:
        return "<secrets>"

    def masked(self, text: str) -> str:
        """Return a message with each secret replaced by `***`."""
        return _replaced(self._everywhere, text)

    def masked_answer(self, text: str) -> str:
        """Return an answer with each secret of at least 6 characters replaced by `***`."""
        return _replaced(self._in_answers, text)


def secrets_in(url: str) -> list[str]:
    """Return the secrets of a URL: credentials of its user, and keys in its query.

    Credentials are the password (without one, the user name), and the encoded pair of both that
    HTTP's `Basic` authorization sends.
    """
    parts = urlsplit(url)
    query = (value for name, value in parse_qsl(parts.query) if _SECRET_PARAMETER.search(name))
    forms = [parts.password or parts.username or "", *query]
    if parts.username or parts.password:
        sent = f"{unquote(parts.username or '')}:{unquote(parts.password or '')}"
        forms += [sent, base64.b64encode(sent.encode(errors="surrogatepass")).decode()]
    return [form for each in forms for form in (each, unquote(each))]


def without_password(url: str) -> str:
    """Return a URL without user, password and the keys in its query, so that it can be shown."""
    parts = urlsplit(url)
    query = Secrets(secrets_in(url)).masked(parts.query)
    return urlunsplit(parts._replace(netloc=parts.netloc.rpartition("@")[2], query=query))


def _replaced(pattern: "re.Pattern[str] | None", text: str) -> str:
    return text if pattern is None else pattern.sub(MASK, text)


def _pattern(secrets: Iterable[str]) -> "re.Pattern[str] | None":
    forms = {form for secret in secrets for form in _forms(secret)}
    # Try the longest first: one secret may be the beginning of another.
    ordered = sorted(forms, key=lambda form: (-len(form), form))
    return re.compile("|".join(ordered)) if ordered else None


def _forms(secret: str) -> Iterator[str]:
    """Yield regular expressions for all forms in which a server may repeat a secret."""
    escapes = (json.dumps(secret)[1:-1], repr(secret)[1:-1], html.escape(secret))
    for plain in (secret, *escapes):
        yield re.escape(plain)
    for encoded in (quote(secret), quote(secret, safe=""), quote_plus(secret)):
        yield re.sub(r"%[0-9A-F]{2}", lambda match: f"(?i:{match[0]})", re.escape(encoded))
    # Hexadecimal bytes, then base64 of a longer text that contains the secret: its encoding
    # depends on the number of preceding bytes modulo 3, and may use either alphabet.
    content = secret.encode(errors="surrogatepass")
    yield f"(?i:{content.hex()})"
    for before in range(3):
        core = _base64_core(content, before)
        if core:
            for alphabet in (core, core.replace("+", "-").replace("/", "_")):
                yield f"{_BASE64}{{0,2}}{re.escape(alphabet)}{_BASE64}*={{0,2}}"


def _base64_core(content: bytes, before: int) -> str:
    """Return the part of a base64 text that depends only on `content`.

    Base64 encodes three bytes as four characters. The characters at the ends also depend on the
    neighbouring bytes and are left out. `before` is the number of preceding bytes modulo 3.
    """
    encoded = base64.b64encode(bytes(before) + content).decode()
    whole = (before + len(content)) * 8 // 6
    return encoded[-(-before * 8 // 6) : whole]
