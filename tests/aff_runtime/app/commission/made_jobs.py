"""In place of a job's process: a script of one's own, which reads what it is to do first."""

import asyncio
import sys

from aff_runtime.app.commission import worker

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
