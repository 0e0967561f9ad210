"""Way to a model's server: proxies and certificates, as variables of the environment direct it."""

import os
import socket
import ssl
import threading
from collections.abc import Mapping
from importlib.util import find_spec
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import proxy_bypass_environment  # type: ignore[attr-defined] # has no type

from beliefnest.llm.failures import UnavailableModelError
from beliefnest.llm.secrets import without_password

SECONDS_TO_CONNECT = 4.0
"""Longest wait for a connection, in seconds."""

_SOCKS = ("socks5", "socks5h")
_PROXY_SCHEMES = ("http", "https", *_SOCKS)


def is_loopback(url: str) -> bool:
    """Return True if a server is on this machine, so that no proxy can reach it."""
    host = (urlsplit(url).hostname or "").rstrip(".").lower()
    if host == "localhost" or host.endswith(".localhost"):
        return True
    try:
        address = ip_address(host)
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None) or address
    return bool(mapped.is_loopback or mapped.is_unspecified)


def proxy_variable(url: str, environment: Mapping[str, str] = os.environ) -> str | None:
    """Return the name of the variable that sends requests to a URL through a proxy; None: none."""
    parts = urlsplit(url)
    if is_loopback(url) or _bypasses(parts.hostname or "", environment):
        return None
    names = (_variable(f"{kind}_proxy", environment) for kind in (parts.scheme, "all"))
    return next(filter(None, names), None)


def check_route(url: str, environment: Mapping[str, str] = os.environ) -> None:
    """Refuse variables of the environment with which no server can be reached.

    The HTTP client reads these variables itself, and its own errors do not name them.

    Raises:
        UnavailableModelError: A proxy or a file of certificates is wrong; the message names the
            variable.
    """
    if not is_loopback(url) and not _bypasses("", environment):
        for kind in ("http", "https", "all"):
            _check_proxy(_variable(f"{kind}_proxy", environment), environment)
    if not is_loopback(url) or urlsplit(url).scheme == "https":
        _check_certificates(environment)


def check_listening(url: str, what: str, advice: str) -> None:
    """Refuse a server that cannot be connected to, before anything long begins.

    Servers behind a proxy are not tried.

    Args:
        url: Address of the server.
        what: The model and its server, for the message.
        advice: What to do if there is no server.

    Raises:
        UnavailableModelError: Nothing listens there, or the host does not exist.
    """
    check_route(url)
    if proxy_variable(url) is not None:
        return
    failures: list[OSError] = []
    parts = urlsplit(url)
    port = parts.port or {"https": 443}.get(parts.scheme, 80)

    def connect() -> None:
        try:
            socket.create_connection((parts.hostname or "", port), SECONDS_TO_CONNECT).close()
        except OSError as error:
            failures.append(error)

    # Nothing interrupts the lookup of a name, so it must not hold up the caller.
    trial = threading.Thread(target=connect, daemon=True)
    trial.start()
    trial.join(SECONDS_TO_CONNECT + 0.5)
    if failures or trial.is_alive():
        raise UnavailableModelError(f"no server for {what}: {advice}")


def _variable(name: str, environment: Mapping[str, str]) -> str | None:
    """Return the spelling of a variable that is set; the one in small letters counts first."""
    return next((each for each in (name, name.upper()) if environment.get(each)), None)


def _bypasses(host: str, environment: Mapping[str, str]) -> bool:
    variable = _variable("no_proxy", environment)
    listed = "" if variable is None else environment[variable]
    everything = "*" in (each.strip() for each in listed.split(","))
    return everything or bool(host and proxy_bypass_environment(host, {"no": listed}))


def _check_proxy(variable: str | None, environment: Mapping[str, str]) -> None:
    if variable is None:
        return
    address = environment[variable]
    full = address if "://" in address else f"http://{address}"
    try:
        parts = urlsplit(full)
        is_address = bool(parts.hostname) and parts.port != 0 and full.isprintable()
    except ValueError:
        is_address = False
    if not is_address or " " in full:
        raise UnavailableModelError(
            f"{variable} is not the address of a proxy; write it as http://HOST:PORT, or unset it"
        )
    if parts.scheme not in _PROXY_SCHEMES:
        raise UnavailableModelError(
            f"{variable} is {without_password(full)}, and {parts.scheme}:// is no kind of proxy "
            f"that can be used: write {', '.join(f'{each}://' for each in _PROXY_SCHEMES)}, or "
            "unset it"
        )
    if parts.scheme in _SOCKS and find_spec("socksio") is None:
        raise UnavailableModelError(
            f"{variable} is {without_password(full)}, and proxies of this kind need the package "
            "socksio: pip install socksio, or unset it"
        )


def _check_certificates(environment: Mapping[str, str]) -> None:
    if file := environment.get("SSL_CERT_FILE"):
        try:
            ssl.create_default_context(cafile=file)
        except FileNotFoundError:
            fault = "and there is no such file"
        except OSError as error:  # ssl.SSLError too
            fault = f"which cannot be read as certificates ({error.strerror or error})"
        else:
            return
        raise UnavailableModelError(f"SSL_CERT_FILE is {file}, {fault}; correct it, or unset it")
    folder = environment.get("SSL_CERT_DIR")
    if folder and not any(Path(each).is_dir() for each in folder.split(os.pathsep)):
        raise UnavailableModelError(
            f"SSL_CERT_DIR is {folder}, and there is no such folder; correct it, or unset it"
        )
