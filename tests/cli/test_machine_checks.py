"""`beliefnest doctor` names conditions of a machine that hurt runs."""

import os
from pathlib import Path

import pytest

from beliefnest.cli.machine_checks import MACHINE_CHECKS
from beliefnest.errors import BeliefNestError

CHECKS = dict(MACHINE_CHECKS)


@pytest.fixture(autouse=True)
def quiet_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in [*os.environ]:
        if name.lower().endswith(("_proxy", "_api_key")) or name in ("PYTHONPATH", "SSL_CERT_FILE"):
            monkeypatch.delenv(name)


def test_a_usual_machine_passes_and_is_left_as_it_was() -> None:
    for check in CHECKS.values():
        check()
    assert [*Path().iterdir()] == []


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("ALL_PROXY", "socks://proxy.lab:1080", "ALL_PROXY is socks://"),
        ("SSL_CERT_FILE", "/nowhere.pem", "SSL_CERT_FILE is /nowhere.pem"),
        ("OPENAI_API_KEY", "sk-1\r", "OPENAI_API_KEY begins or ends with white space"),
    ],
)
def test_a_variable_that_spoils_connections_is_named(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str, told: str
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(BeliefNestError, match=told):
        CHECKS["routes"]()


def test_proxies_are_named_where_they_are_well(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HTTPS_PROXY", "http://proxy.lab:3128")
    assert CHECKS["routes"]().startswith("HTTPS_PROXY: for providers")


def test_a_file_with_the_name_of_a_module_of_python_is_named() -> None:
    Path("random.py").write_text("")
    with pytest.raises(BeliefNestError, match=r"hidden by .*random\.py"):
        CHECKS["modules"]()


def test_a_folder_that_cannot_be_written_is_named(tmp_path, monkeypatch) -> None:
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(BeliefNestError, match="cannot be written"):
        CHECKS["folder"]()
