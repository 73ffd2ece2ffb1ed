"""What was measured already: a run that was stopped, or that failed late, goes on from there."""

from __future__ import annotations

import json
import shutil
import traceback
from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from typing import TypeVar

import numpy as np

from benchmarks.runtime.facts import FactRow
from benchmarks.screen.ticks import Block

PLAN = "plan.json"
T = TypeVar("T")


class Kept:
    """Blocks and rows by name, each in a file of its own that is there whole or not at all.

    Parameters
    ----------
    plan : what makes two runs the same; what was kept of another one is dropped.

    Attributes
    ----------
    failed : why a part came to nothing in this run, by its name.
    """

    def __init__(self, folder: Path, plan: dict[str, object]) -> None:
        self._folder = folder
        self.failed: dict[str, str] = {}
        text = json.dumps(plan, sort_keys=True)
        said = folder / PLAN
        if folder.exists() and (not said.exists() or said.read_text() != text):
            shutil.rmtree(folder)
        folder.mkdir(parents=True, exist_ok=True)
        said.write_text(text)

    def block(self, name: str, measure: Callable[[], Block]) -> Block | None:
        """Return a block, measured now where it was not; None where it fails."""
        path = self._folder / f"{name}.npz"
        if not path.exists():
            found = self._try(name, measure)
            if found is None:
                return None
            rest = path.with_suffix(".part")
            with rest.open("wb") as file:
                np.savez_compressed(file, **asdict(found))
            rest.rename(path)
        with np.load(path) as said:
            values = {
                f.name: said[f.name] if f.name == "end_us" else said[f.name].item()
                for f in fields(Block)
            }
        return Block(**values)

    def rows(self, name: str, measure: Callable[[], list[FactRow]]) -> list[FactRow]:
        """Return the rows of a part, measured now where they were not; why not where it fails."""
        path = self._folder / f"{name}.json"
        if not path.exists():
            found = self._try(name, measure)
            if found is None:
                return [FactRow(name=name, value="not measured", remark=self.failed[name][:120])]
            rest = path.with_suffix(".part")
            rest.write_text(json.dumps([asdict(row) for row in found]))
            rest.rename(path)
        return [FactRow(**row) for row in json.loads(path.read_text())]

    def drop(self) -> None:
        """Forget everything: it stands on a page."""
        shutil.rmtree(self._folder)

    def _try(self, name: str, measure: Callable[[], T]) -> T | None:
        try:
            return measure()
        except Exception as error:
            traceback.print_exc()
            self.failed[name] = f"{type(error).__name__}: {' '.join(str(error).split())}"
            return None
