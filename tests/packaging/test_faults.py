"""Seeded faults: each is a fault of the source as it is."""

from tests.faults.__main__ import PACKAGE, ROOT, faults


def test_the_text_of_each_fault_is_in_its_file_once() -> None:
    stale = {
        fault.name: count
        for fault in faults()
        if (count := (ROOT / PACKAGE / fault.file).read_text().count(fault.old)) != 1
    }
    assert not stale, "mend `old` of these rows in tests/faults/table.toml"
