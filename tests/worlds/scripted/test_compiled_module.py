"""Machine code that is kept on disk is run only as it was written."""

import hashlib

from beliefnest.worlds.scripted import compiled_module


def test_damaged_machine_code_is_compiled_anew(tmp_path):
    file = tmp_path / "kept.cwasm"
    code = b"machine code"
    file.write_bytes(hashlib.sha256(code).digest() + code)
    assert compiled_module._kept(file) == code
    file.write_bytes(file.read_bytes()[:-1] + b"!")
    assert compiled_module._kept(file) is None
