"""The providers of chat models: where they are, and which variables hold their keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from ipaddress import ip_address
from typing import Literal
from urllib.parse import unquote, urlsplit, urlunsplit

from beliefnest.errors import ModelError
from beliefnest.llm.secrets import Secrets, secrets_in, without_password

__all__ = ["PROVIDERS", "Endpoint", "Provider", "endpoint"]

Protocol = Literal["openai", "compatible", "anthropic", "google"]


@dataclass(frozen=True, slots=True)
class Provider:
    """A provider of chat models.

    Attributes:
        name: What stands before the colon in `PROVIDER:MODEL`.
        protocol: What its servers speak.
        key_variables: Variables of the environment that may hold the key, in order.
        url_variable: Variable that may hold the base URL.
        default_url: Base URL without that variable; None: there is none.
        needs_key: Whether it refuses to answer without a key.
        free: Whether it runs on the user's own machine and costs nothing.
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
    """Where a provider is spoken to and with which key.

    Attributes:
        provider: The provider.
        url: Base URL, perhaps with a password in it; `place` is what may be shown.
        key: Never printed; None where none is needed.
        key_variable: The variable the key came from, for messages.
    """

    provider: Provider
    url: str = field(repr=False)
    key: "_Key"
    key_variable: str

    @cached_property
    def place(self) -> str:
        """The base URL without user, password or key."""
        return without_password(self.url)

    @property
    def address(self) -> str:
        """The base URL without user and password, to be asked with `user`.

        Libraries write the address that they ask into logs and errors.
        """
        parts = urlsplit(self.url)
        return urlunsplit(parts._replace(netloc=parts.netloc.rpartition("@")[2]))

    @property
    def user(self) -> tuple[str, str] | None:
        """User and password that the base URL holds; None: none."""
        parts = urlsplit(self.url)
        if not parts.username and not parts.password:
            return None
        return unquote(parts.username or ""), unquote(parts.password or "")

    @cached_property
    def secrets(self) -> Secrets:
        """What nothing that is shown or kept may hold."""
        return Secrets([self.key.value or "", *secrets_in(self.url)])

    def cost(self, listed: float | None) -> float | None:
        """US dollars that an answer costs, None where that is not known.

        Args:
            listed: What the library's price list says; None: the model is not on it.
        """
        if self.provider.free:
            return 0.0
        # A provider's name says that what is asked may be handed on to it.
        is_own = self.provider.default_url is None and _is_near(self.url)
        return 0.0 if listed is None and is_own else listed


@dataclass(frozen=True, slots=True, repr=False)
class _Key:
    """A key that does not show in a representation."""

    value: str | None

    def __repr__(self) -> str:
        return "<key>" if self.value else "<no key>"


PROVIDERS: Mapping[str, Provider] = {
    provider.name: provider
    for provider in (
        Provider(
            "openai",
            "openai",
            ("OPENAI_API_KEY",),
            "OPENAI_BASE_URL",
            "https://api.openai.com/v1",
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
"""Name to provider; `compatible` is any other server that speaks OpenAI's protocol."""


def _is_near(url: str) -> bool:
    """Return True if a server is on this machine, or has an address of a private network."""
    host = urlsplit(url).hostname or ""
    try:
        return host == "localhost" or ip_address(host).is_private
    except ValueError:
        # A name, which may lead anywhere.
        return False


def _is_address(url: str) -> bool:
    try:
        parts = urlsplit(url)
        return bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False


def endpoint(provider: Provider, environment: Mapping[str, str]) -> Endpoint:
    """Where a provider is, and the key, from the environment.

    Raises:
        ModelError: A key or a URL is needed and not in the environment.
    """
    url = environment.get(provider.url_variable) or provider.default_url
    if not url:
        raise ModelError(
            f"{provider.name} needs the server's address: "
            f"set {provider.url_variable}, as http://localhost:8000/v1"
        )
    if not _is_address(url):
        raise ModelError(
            f"{provider.url_variable} is no address of a server; write it as "
            "http://localhost:8000/v1, with special characters of a password as %40"
        )
    for variable in provider.key_variables:
        if environment.get(variable):
            return Endpoint(provider, url, _Key(environment[variable]), variable)
    # A server at an address of the user's own may do without a key.
    if provider.needs_key and not environment.get(provider.url_variable):
        raise ModelError(
            f"{provider.name} needs a key: set {' or '.join(provider.key_variables)}, "
            "or run with --model offline"
        )
    return Endpoint(provider, url, _Key(None), provider.key_variables[0])
