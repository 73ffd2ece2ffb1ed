"""The bench's container file asks for what a release has, and says what the programs take.

No engine is needed: `docker build` itself is not tried here.
"""

from __future__ import annotations

import json
import re
import shlex

from releasing.commands import ROOT
from releasing.lock import EXTRAS
from sim_plant.base.shipped import shipped
from sim_plant.cli.main import build_parser

FILE = ROOT / "deploy" / "bench" / "Containerfile"
TEXT = re.sub(r"(?m)^#.*\n", "", FILE.read_text()).replace("\\\n", " ")
STEPS = [line.partition(" ")[::2] for line in TEXT.splitlines() if line]


def of(word: str) -> list[str]:
    """Return what stands behind each step of a kind."""
    return [rest for step, rest in STEPS if step == word]


def test_every_file_that_is_copied_is_made_by_a_release() -> None:
    (copied,) = of("COPY")
    *names, _ = copied.split()
    locks = {f"lock-{name}.txt" for name in EXTRAS}
    assert {name for name in names if name.startswith("lock-")} == {
        "lock-plant.txt",
        "lock-can.txt",
    }
    assert {name for name in names if name.endswith(".txt")} <= locks
    assert [name for name in names if name.endswith(".whl")] == ["aff_runtime-*-py3-none-any.whl"]


def test_packages_come_by_their_hashes_and_the_product_alone_without() -> None:
    installs = [words for words in of("RUN")[0].split("&&") if "pip install" in words]
    assert ["--require-hashes" in words for words in installs] == [True, False]
    assert "--no-deps" in installs[1]


def test_what_it_runs_is_taken_by_the_program_and_it_does_not_run_as_root() -> None:
    (program,) = json.loads(of("ENTRYPOINT")[0])
    assert program == "sim-plant"
    served = json.loads(of("CMD")[0])
    compiled = shlex.split(of("RUN")[1].partition("&&")[0])[1:]
    for words in (served, compiled):
        options = build_parser().parse_args(words)
        assert options.line.parts[0] == "lines"
        assert shipped(str(options.line)).is_file()
    port = served[served.index("--modbus") + 1].rpartition(":")[2]
    assert of("EXPOSE") == [port]
    assert [step for step, _ in STEPS].index("USER") < [step for step, _ in STEPS].index("CMD")
    assert of("USER") == ["bench"]


def test_no_registry_is_named() -> None:
    assert of("ARG") == ["BASE=python:3.11-slim"]
    assert of("FROM") == ["${BASE}"]
