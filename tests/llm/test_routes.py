"""Proxies, certificates and keys in the environment: loopback needs none, and faults are named."""

import pytest

from beliefnest.errors import ModelError
from beliefnest.llm import Message, Sampling, resolve_model
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.llm.providers import PROVIDERS, endpoint
from beliefnest.llm.routes import check_route, is_loopback, proxy_variable

ASK = (Message("user", "Get a diamond."),)
FAR = "https://models.example.org/v1"
DEAD = "http://127.0.0.1:9"


@pytest.fixture(autouse=True)
def nothing_set(monkeypatch):
    for name in (
        "http_proxy",
        "https_proxy",
        "all_proxy",
        "no_proxy",
        "ssl_cert_file",
        "ssl_cert_dir",
    ):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("HTTP_PROXY", DEAD),
        ("http_proxy", DEAD),
        ("ALL_PROXY", DEAD),
        ("ALL_PROXY", "socks://127.0.0.1:9"),
        ("all_proxy", "socks5h://127.0.0.1:9"),
        ("HTTP_PROXY", "nonsense://"),
        ("SSL_CERT_FILE", "/missing/ca.pem"),
        ("SSL_CERT_DIR", "/missing"),
    ],
)
@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_a_server_on_this_machine_is_asked_directly(fake, monkeypatch, name, value, host):
    monkeypatch.setenv(name, value)
    fake.will(fake.says("go();"))
    own = {"VLLM_BASE_URL": fake.url.replace("127.0.0.1", host)}
    assert resolve_model("vllm:m", own).answer(ASK, Sampling()).text == "go();"


@pytest.mark.parametrize(
    ("url", "near"),
    [
        ("http://127.0.0.1:8000/v1", True),
        ("http://127.9.8.7/v1", True),
        ("http://LOCALHOST:1/v1", True),
        ("http://models.localhost/v1", True),
        ("http://[::1]:8000/v1", True),
        ("http://[::ffff:127.0.0.1]:8000/v1", True),
        ("http://0.0.0.0:8000/v1", True),
        ("http://192.168.1.7:8000/v1", False),
        ("http://localhost.example.org/v1", False),
        ("https://127.0.0.1.example.org/v1", False),
    ],
)
def test_loopback_is_told_from_other_servers(url, near):
    assert is_loopback(url) is near
    found = proxy_variable(url, {"ALL_PROXY": DEAD})
    assert found == (None if near else "ALL_PROXY")


@pytest.mark.parametrize(
    ("environment", "variable"),
    [
        ({"HTTPS_PROXY": DEAD, "ALL_PROXY": DEAD}, "HTTPS_PROXY"),
        ({"https_proxy": DEAD, "HTTPS_PROXY": DEAD}, "https_proxy"),
        ({"HTTP_PROXY": DEAD}, None),
        ({"HTTPS_PROXY": DEAD, "NO_PROXY": "example.org"}, None),
        ({"HTTPS_PROXY": DEAD, "no_proxy": "a.org, *"}, None),
        ({"HTTPS_PROXY": DEAD, "NO_PROXY": "a.org"}, "HTTPS_PROXY"),
        ({"HTTPS_PROXY": ""}, None),
    ],
)
def test_the_variable_of_a_proxy_is_found(environment, variable):
    assert proxy_variable(FAR, environment) == variable


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("ALL_PROXY", "socks://proxy:1080", r"ALL_PROXY is socks://proxy:1080, and socks://"),
        ("all_proxy", "ftp://me:secret@proxy:21", r"all_proxy is ftp://proxy:21"),
        ("HTTPS_PROXY", "http://", "HTTPS_PROXY is not the address of a proxy"),
        ("HTTPS_PROXY", "http://proxy:x", "HTTPS_PROXY is not the address of a proxy"),
        ("HTTP_PROXY", "http://proxy:8080\r", "HTTP_PROXY is not the address of a proxy"),
        ("SSL_CERT_FILE", "/missing/ca.pem", "SSL_CERT_FILE is /missing/ca.pem, and there is no"),
        ("SSL_CERT_FILE", __file__, "SSL_CERT_FILE is .*cannot be read as certificates"),
        ("SSL_CERT_DIR", "/missing", "SSL_CERT_DIR is /missing, and there is no such folder"),
    ],
)
def test_a_variable_that_spoils_connections_is_named(monkeypatch, name, value, message):
    with pytest.raises(UnavailableModelError, match=message) as fault:
        check_route(FAR, {name: value})
    assert "secret" not in str(fault.value)
    monkeypatch.setenv(name, value)
    with pytest.raises(UnavailableModelError, match=message):
        resolve_model("compatible:m", {"COMPATIBLE_BASE_URL": FAR}).answer(ASK, Sampling())


def test_a_proxy_that_is_not_there_is_named(monkeypatch):
    monkeypatch.setenv("HTTPS_PROXY", "http://127.0.0.1:1")
    told = (
        r"no server for compatible:m at https://models\.example\.org/v1 through the proxy of HTTPS"
    )
    with pytest.raises(UnavailableModelError, match=told):
        resolve_model("compatible:m", {"COMPATIBLE_BASE_URL": FAR}).answer(ASK, Sampling())


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("VLLM_API_KEY", "sk-1\r\n", "VLLM_API_KEY has a line end, .*Windows.* at place 5 of 6"),
        ("VLLM_API_KEY", "sk-1\n", "VLLM_API_KEY has a line end"),
        ("VLLM_API_KEY", " sk-1", "VLLM_API_KEY has a space, at place 1"),
        ("VLLM_API_KEY", "\ufeffsk-1", r"VLLM_API_KEY has the character '\\ufeff'"),
        ("VLLM_API_KEY", "“sk-1”", r"VLLM_API_KEY has the character '\\u201c'"),
        ("VLLM_BASE_URL", "http://localhost:1/v1\r", "VLLM_BASE_URL has a line end"),
        ("VLLM_BASE_URL", "localhost:1/v1", "VLLM_BASE_URL is not the address of a server"),
    ],
)
def test_a_key_or_address_that_cannot_be_sent_is_named(name, value, message):
    with pytest.raises(ModelError, match=message) as fault:
        endpoint(PROVIDERS["vllm"], {name: value})
    assert "sk-1" not in str(fault.value)
