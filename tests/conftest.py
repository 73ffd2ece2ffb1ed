"""What holds for the whole suite: one thread a process, and the longest files first.

Ten thousand tests and the modules that they import stay until the end: the collector of garbage
looks through them neither while they are made nor afterwards.
"""

from __future__ import annotations

import gc
import os
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.failed_tries import (  # noqa: F401  (hooks of this suite)
    pytest_runtest_makereport,
    pytest_runtest_setup,
    pytest_terminal_summary,
)
from tests.temporary_folder import tmp_path  # noqa: F401  (in the place of pytest's own)

# before numpy is there: two workers with two threads each would wait for each other on two cores
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMEXPR_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
# pydantic asks every package installed here for its plugins, in each of hundreds of processes
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

gc.disable()  # until all tests are collected: else it takes as long as everything else about them

QUICK_EXAMPLES = 25
"""Drawn inputs of a test that names no number; `make test-long` draws hypothesis' own hundred."""

# a machine that paused is no defect of what is tested: hypothesis measures no time
settings.register_profile(
    "long", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.register_profile("aff", settings.get_profile("long"), max_examples=QUICK_EXAMPLES)
settings.load_profile("aff")

LONGEST_FIRST = (
    "hil/test_faults.py",
    "matrix/test_matrix.py",
    "aff_runtime/app/test_service.py",
    "hil/test_shape.py",
    "lockstep/test_faults.py",
    "sim_plant/refine/test_runs.py",
    "aff_runtime/cli/test_setup.py",
    "aff_runtime/app/setup/test_unusual_plants.py",
    "aff_runtime/app/test_commissioning_kills.py",
    "aff_runtime/app/test_settings.py",
    "lockstep/test_shape_law.py",
    "matrix/test_may.py",
    "aff_runtime/app/setup/test_bus_at_work.py",
    "aff_runtime/core/test_controller.py",
    "hil/test_operator.py",
    "aff_runtime/app/commission/test_words.py",
    "sim_plant/refine/records/test_lossy_recorder.py",
    "benchmarks/campaign/test_other_code.py",
)
"""Files that take longest: begun last, one of them keeps one core waiting. What lives in real time
stands beside what computes for long."""


REAL_TIME = frozenset({"wire", "hil", "processes"})
TRIES_AGAIN = 2
"""Of a test in real time that failed: a machine that paused for 100 ms is no defect of ours. A
defect shows three times; the summary lists each try as RERUN and says why."""


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave the tests in a browser unread where they are not asked for: each worker reads all."""
    is_asked = "not browser" not in config.getoption("markexpr")
    return None if is_asked or collection_path.name != "browser" else True


def _keep_a_few(items: list[pytest.Item]) -> None:
    """Of a test with ``sweep(every=n)`` leave each n-th case in the quick suite."""
    seen: Counter[str] = Counter()
    for item in items:
        sweep = item.get_closest_marker("sweep")
        if sweep is not None:
            name = item.nodeid.partition("[")[0]
            if seen[name] % int(sweep.kwargs["every"]):
                item.add_marker(pytest.mark.long)
            seen[name] += 1


@pytest.hookimpl(tryfirst=True)  # before `-m` chooses
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the longest files first, in every worker the same; try again what lives in real time."""
    _keep_a_few(items)
    root = config.rootpath / "tests"
    place = {root / name: at for at, name in enumerate(LONGEST_FIRST)}
    items.sort(key=lambda item: place.get(item.path, len(place)))
    for item in items:
        if not REAL_TIME.isdisjoint(mark.name for mark in item.iter_markers()):
            item.add_marker(pytest.mark.flaky(reruns=TRIES_AGAIN, reruns_delay=1))


RARELY = 20_000
"""New objects between two collections: at Python's 700 they take a tenth of a core."""


def pytest_collection_finish() -> None:
    """Collect garbage from here on, of what the tests themselves leave."""
    gc.freeze()
    gc.set_threshold(RARELY, *gc.get_threshold()[1:])
    gc.enable()
