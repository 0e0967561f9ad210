"""Worker processes end with the process that started them."""

import subprocess
import sys

OWNER = """
import subprocess, sys, time
worker = "import os, time; from beliefnest.plan.ending import end_with; "
worker += "end_with(os.getppid()); print('begun', flush=True); time.sleep(3600)"
subprocess.run([sys.executable, "-c", worker])
"""


def test_a_worker_ends_with_a_study_that_is_killed():
    with subprocess.Popen([sys.executable, "-c", OWNER], stdout=subprocess.PIPE) as owner:
        assert owner.stdout.readline() == b"begun\n"
        owner.kill()
        # The end of what the worker may write is its own end.
        assert owner.stdout.read() == b""
