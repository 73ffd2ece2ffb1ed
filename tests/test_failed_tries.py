"""A failed try: what it left open is not counted against the next test, its reason is shown."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
TESTS = '''
import gc, socket
import pytest

TRIES = []

class Open:
    """A socket in a cycle, like what a traceback keeps: only the collector finds it."""

    def __init__(self):
        self.own, self.end = self, socket.socket()

@pytest.mark.flaky(reruns=1)
def test_passes_the_second_time():
    TRIES.append(1)
    left = Open()
    assert len(TRIES) == 2, "the line stood"
    left.end.close()

def test_after_it():
    gc.collect()

def test_fails_for_good():
    left = Open()
    raise ValueError("no line")

def test_after_that():
    gc.collect()

def test_leaves_something_open_itself():
    Open()
    gc.collect()
'''


def test_a_failed_try_fails_no_other_test_and_says_why(tmp_path: Path) -> None:
    (tmp_path / "test_some.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\nfilterwarnings = error\n")
    options = ["-p", "tests.failed_tries", "-rA", "--tb=no", str(tmp_path)]
    command = [sys.executable, "-m", "pytest", *options]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    outcomes = {
        name: word
        for word, name in re.findall(r"^(PASSED|FAILED) \S*::test_(\w+)", run.stdout, re.MULTILINE)
    }
    assert outcomes == {
        "passes_the_second_time": "PASSED",
        "after_it": "PASSED",
        "fails_for_good": "FAILED",
        "after_that": "PASSED",
        "leaves_something_open_itself": "FAILED",
    }
    assert re.search(
        r"tried again: .*passes_the_second_time \(call\): .*the line stood", run.stdout
    )
