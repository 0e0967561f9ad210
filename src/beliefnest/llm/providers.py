"""Providers of chat models: their addresses, and the variables that hold their keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from ipaddress import ip_address
from typing import Literal
from urllib.parse import unquote, urlsplit, urlunsplit

import msgspec

from beliefnest.errors import ModelError
from beliefnest.llm.secrets import Secrets, secrets_in, without_password

Protocol = Literal["openai", "compatible", "anthropic", "google"]


class Provider(msgspec.Struct, frozen=True):
    """A provider of chat models.

    Attributes:
        name: Part before the colon in `PROVIDER:MODEL`.
        protocol: Protocol of its servers.
        key_variables: Environment variables that may hold the key, in order.
        url_variable: Environment variable that may hold the base URL.
        default_url: Base URL if this variable is not set; None if there is no default.
        needs_key: True if the provider answers only with a key.
        free: True if it runs on the user's own machine and costs nothing.
    """

    name: str
    protocol: Protocol
    key_variables: tuple[str, ...]
    url_variable: str
    default_url: str | None
    needs_key: bool = True
    free: bool = False


@dataclass(frozen=True)
class Endpoint:
    """Server and key of a provider.

    Attributes:
        provider: The provider.
        url: Base URL, which may contain a password; show `place` instead.
        key: Key, never printed; None if none is needed.
        key_variable: Variable that held the key, for messages.
    """

    provider: Provider
    url: str = field(repr=False)
    key: "_Key"
    key_variable: str

    @cached_property
    def place(self) -> str:
        """Base URL without user, password or key."""
        return without_password(self.url)

    @property
    def advice(self) -> str:
        """Advice to the user if no server listens at the address."""
        variable = self.provider.url_variable
        if self.provider.default_url is None or self.provider.free:
            return f"start it, or set {variable}"
        return f"check the network, or set {variable}"

    @property
    def address(self) -> str:
        """Base URL without user and password, to be requested with `user`.

        Libraries write this address into logs and errors.
        """
        parts = urlsplit(self.url)
        return urlunsplit(parts._replace(netloc=parts.netloc.rpartition("@")[2]))

    @property
    def user(self) -> tuple[str, str] | None:
        """User and password in the base URL; None if there are none."""
        parts = urlsplit(self.url)
        if not parts.username and not parts.password:
            return None
        return unquote(parts.username or ""), unquote(parts.password or "")

    @cached_property
    def secrets(self) -> Secrets:
        """Secrets that must not appear in any output or file."""
        return Secrets([self.key.value or "", *secrets_in(self.url)])

    def cost(self, listed: float | None) -> float | None:
        """Return the cost of an answer in US dollars; None if it is unknown.

        Args:
            listed: Price by the library's list; None if the list lacks the model.
        """
        if self.provider.free:
            return 0.0
        # A local server may be a proxy: if the model is on the price list, the request may be
        # forwarded to its provider, and the listed price applies.
        is_own = self.provider.default_url is None and _is_near(self.url)
        return 0.0 if listed is None and is_own else listed


@dataclass(frozen=True, slots=True, repr=False)
class _Key:
    """A key that its representation does not show."""

    value: str | None

    def __repr__(self) -> str:
        return "<key>" if self.value else "<no key>"


PROVIDERS: Mapping[str, Provider] = {
    provider.name: provider
    for provider in (
        Provider(
            "openai", "openai", ("OPENAI_API_KEY",), "OPENAI_BASE_URL", "https://api.openai.com/v1"
        ),
        Provider(
            "anthropic",
            "anthropic",
            ("ANTHROPIC_API_KEY",),
            "ANTHROPIC_BASE_URL",
            "https://api.anthropic.com",
        ),
        Provider(
            "google",
            "google",
            ("GOOGLE_API_KEY", "GEMINI_API_KEY"),
            "GOOGLE_GEMINI_BASE_URL",
            "https://generativelanguage.googleapis.com",
        ),
        Provider(
            "ollama",
            "compatible",
            ("OLLAMA_API_KEY",),
            "OLLAMA_BASE_URL",
            "http://localhost:11434/v1",
            needs_key=False,
            free=True,
        ),
        Provider(
            "vllm",
            "compatible",
            ("VLLM_API_KEY",),
            "VLLM_BASE_URL",
            "http://localhost:8000/v1",
            needs_key=False,
            free=True,
        ),
        Provider(
            "lmstudio",
            "compatible",
            ("LMSTUDIO_API_KEY",),
            "LMSTUDIO_BASE_URL",
            "http://localhost:1234/v1",
            needs_key=False,
            free=True,
        ),
        Provider(
            "compatible",
            "compatible",
            ("COMPATIBLE_API_KEY",),
            "COMPATIBLE_BASE_URL",
            None,
            needs_key=False,
        ),
    )
}
"""Providers by name; `compatible` is any other server with OpenAI's protocol."""


def _is_near(url: str) -> bool:
    """Return True if a server is on this machine or has an address of a private network."""
    host = urlsplit(url).hostname or ""
    try:
        return host == "localhost" or ip_address(host).is_private
    except ValueError:
        # A host name can belong to any address.
        return False


def _is_address(url: str) -> bool:
    try:
        parts = urlsplit(url)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False


def check_visible(variable: str, value: str) -> None:
    """Refuse a key or an address that cannot be sent, without showing it.

    Raises:
        ModelError: It has a space, a line end, or a character beyond ASCII.
    """
    for number, character in enumerate(value, start=1):
        if "!" <= character <= "~":
            continue
        if character in "\r\n":
            what = "a line end, as files made on Windows have it"
        else:
            what = "a space" if character == " " else f"the character {character!a}"
        raise ModelError(
            f"{variable} has {what}, at place {number} of {len(value)}; set it again without that"
        )


def endpoint(provider: Provider, environment: Mapping[str, str]) -> Endpoint:
    """Return the address and the key of a provider from the environment.

    Raises:
        ModelError: The environment lacks a key or a URL that is needed.
    """
    url = environment.get(provider.url_variable) or provider.default_url
    if not url:
        raise ModelError(
            f"{provider.name} needs the server's address: "
            f"set {provider.url_variable}, as http://localhost:8000/v1"
        )
    check_visible(provider.url_variable, url)
    if not _is_address(url):
        raise ModelError(
            f"{provider.url_variable} is not the address of a server; write it as "
            "http://localhost:8000/v1, with special characters of a password as %40"
        )
    for variable in provider.key_variables:
        if environment.get(variable):
            check_visible(variable, environment[variable])
            return Endpoint(provider, url, _Key(environment[variable]), variable)
    # Servers at an address that the user chose may not need a key.
    if provider.needs_key and not environment.get(provider.url_variable):
        raise ModelError(
            f"{provider.name} needs a key: set {' or '.join(provider.key_variables)}, "
            "or run with --model offline"
        )
    return Endpoint(provider, url, _Key(None), provider.key_variables[0])
