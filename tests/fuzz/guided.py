"""``python -m tests.fuzz.guided TARGET SECONDS FOLDER``: one target, by atheris if it is there.

Prints one line of JSON: runs, what became of the inputs, and the input that broke it, if any.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import logging
import sys
import time
import traceback
from collections import Counter
from pathlib import Path
from typing import Any

BATCH = 500
INSTRUMENTED = ["aff_runtime", "aff_hmi", "sim_plant.refine.records", "sim_plant.base"]


class Count:
    """Runs a target and counts; the first input that raises is kept and ends the run."""

    def __init__(self, name: str, folder: Path) -> None:
        self.target = importlib.import_module("tests.fuzz.targets").TARGETS[name]
        self.became: Counter[str] = Counter()
        self.trouble = ""
        self._kept = folder / f"{name}.broken"

    def __call__(self, data: bytes) -> None:
        try:
            self.became[self.target.run(bytes(data))] += 1
        except Exception:
            self.trouble = traceback.format_exc()
            self._kept.write_bytes(data)
            raise

    def report(self, how: str) -> dict[str, Any]:
        return {
            "by": how,
            "runs": sum(self.became.values()),
            "became": dict(self.became),
            "trouble": self.trouble,
        }


def by_chance(name: str, seconds: float, folder: Path) -> dict[str, Any]:
    """Mutations of the seeds, a new batch each time, until the time is over."""
    from tests.fuzz.source import mutations

    count = Count(name, folder)
    end_s, seed = time.monotonic() + seconds, 0
    while time.monotonic() < end_s:
        seed += 1
        for data in mutations(count.target.seeds, BATCH, seed):
            try:
                count(data)
            except Exception:
                return count.report("chance")
            if time.monotonic() >= end_s:
                break
    return count.report("chance")


def by_coverage(name: str, seconds: float, folder: Path) -> None:
    """Atheris: keep what reaches new lines of the runtime and go on from there; never returns."""
    import atheris

    with atheris.instrument_imports(include=INSTRUMENTED, enable_loader_override=False):
        count = Count(name, folder)
    corpus = folder / f"{name}.corpus"
    corpus.mkdir(exist_ok=True)
    for index, seed in enumerate(count.target.seeds):
        (corpus / f"seed{index}").write_bytes(seed)
    end_s = time.monotonic() + seconds

    def one(data: bytes) -> None:
        over = time.monotonic() >= end_s
        if not over:
            try:
                count(data)
            except Exception:
                over = True
        if over:  # libFuzzer ends the process its own way: say it before
            print(json.dumps(count.report("coverage")), flush=True)
            sys.stdout.close()
            import os

            os._exit(0)

    atheris.Setup([name, "-verbosity=0", "-max_len=4096", "-rss_limit_mb=4096", str(corpus)], one)
    atheris.Fuzz()


def main(name: str, seconds: str, where: str) -> None:
    logging.disable(logging.CRITICAL)
    folder = Path(where)
    if importlib.util.find_spec("atheris") is None:
        print(json.dumps(by_chance(name, float(seconds), folder)))
    else:
        by_coverage(name, float(seconds), folder)


if __name__ == "__main__":
    main(*sys.argv[1:4])
