"""A job ends with its commissioner, in the middle of what it does."""

import io
import json
import os
import subprocess
import sys
import time
from pathlib import Path

from aff_runtime.app.commission import job
from tests.processes import forked

NAMES = ("site", "state", "socket", "card")
BUSY = """
import time
from aff_runtime.app.commission import job

def busy(where, asked, talk):
    talk.say("at it")
    time.sleep(600)

job.JOBS["verify"] = busy
job.main()
"""
COMMISSIONER = """
import json, os, subprocess, sys

child = subprocess.Popen([sys.executable, "-c", sys.argv[1]], stdin=-1, stdout=-1, text=True)
asked = {**json.loads(sys.argv[2]), "parent": os.getpid()}
print(json.dumps(asked), file=child.stdin, flush=True)
child.stdout.readline()
print(child.pid, flush=True)
child.wait()
"""


def asked(folder):
    return {"do": "verify", "where": dict.fromkeys(NAMES, os.fspath(folder))}


def is_there(pid):
    """Return whether a process runs; one that nobody has waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_busy_job_ends_when_its_commissioner_is_killed(tmp_path):
    words = [sys.executable, "-c", COMMISSIONER, BUSY, json.dumps(asked(tmp_path))]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as commissioner:
        pid = int(commissioner.stdout.readline())
        assert is_there(pid)
        commissioner.kill()
    give_up = time.monotonic() + 20.0
    while is_there(pid) and time.monotonic() < give_up:
        time.sleep(0.02)
    if is_there(pid):
        os.kill(pid, 9)
        raise AssertionError("the job went on")


def test_a_job_whose_commissioner_has_ended_before_does_nothing(tmp_path):
    another = {**asked(tmp_path), "parent": os.getppid()}
    said = tmp_path / "said"

    def begin():
        sys.stdin = io.StringIO(json.dumps(another) + "\n")
        os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT), 1)
        os._exit(job.main())

    _, ended = os.waitpid(forked(begin), 0)
    assert (os.waitstatus_to_exitcode(ended), said.read_text()) == (1, "")
