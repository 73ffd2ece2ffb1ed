"""In place of a job's process: a script of one's own, or the job itself in this process."""

import asyncio
import sys
from io import StringIO

from aff_runtime.app.commission import paths
from aff_runtime.app.commission.job import JOBS
from aff_runtime.app.commission.link.job_lines import Ended, Refused, encode, read_start
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.serving import worker
from aff_runtime.base.errors import AffError
from tests.aff_runtime.app.judged_here import judged_here

HEAD = "import json, os, sys, time\nasked = json.loads(sys.stdin.readline())\n"
SAY = "print(json.dumps({!r}), flush=True)\n"


def say(**said):
    """Return the line of a script that says this."""
    return SAY.format(said)


def ask(name="host"):
    """Return the lines of a script that asks, and waits for the answer."""
    asked = {"number": 1, "name": name, "text": "Address", "default": None}
    return say(ask={**asked, "choices": [], "rows": []}) + "sys.stdin.readline()\n"


def until(path):
    """Return the lines of a script that wait for a file."""
    return f"while not os.path.exists({str(path)!r}):\n    time.sleep(0.01)\n"


def play(monkeypatch, script):
    """Have every job be this script."""

    async def child(module, environment, most_bytes):
        return await asyncio.create_subprocess_exec(
            sys.executable,
            "-c",
            HEAD + script,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            env=environment,
            limit=most_bytes,
        )

    monkeypatch.setattr(worker, "talking_child", child)


class Here:
    """What a worker sees of a job that is done in this process, once it has been told which."""

    returncode = None

    def __init__(self):
        self.stdin, self.stdout = self, asyncio.StreamReader()

    def write(self, line):
        start, said = read_start(line.decode()), StringIO()
        talk = Talk(StringIO(), said)
        try:
            talk.tell(Ended(answer=JOBS[start.asked.do](start.where, start.asked, talk)))
        except AffError as error:
            said.write(encode(Refused(text=str(error))) + "\n")
        self.stdout.feed_data(said.getvalue().encode())
        self.stdout.feed_eof()
        self.returncode = 0

    async def wait(self):
        return self.returncode


def do_here(monkeypatch):
    """Have every job, and the check of the site file in it, done in this process.

    A process for each takes two seconds of a core.
    """

    async def child(module, environment, most_bytes):
        return Here()

    monkeypatch.setattr(paths, "load_parameters", judged_here)
    monkeypatch.setattr(worker, "talking_child", child)
