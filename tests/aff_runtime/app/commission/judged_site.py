"""A site file of the shipped ones, and jobs that judge it without a process of their own."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import ModuleType

import pytest

from aff_runtime.app.commission.paths import Paths
from tests.aff_runtime.app.judged_here import judged_here
from tests.parameter_records import CONFIG


def judged_site(folder: Path, patched: pytest.MonkeyPatch, *modules: ModuleType) -> Paths:
    """Return where a copy of it is; ``modules`` judge a site file here."""
    for module in modules:
        patched.setattr(module, "load_parameters", judged_here)
    site = folder / "site.yaml"
    shutil.copyfile(CONFIG / "euclid_blocks.yaml", site)
    return Paths(site=site, state=folder, socket=folder / "none", card=folder / "card")
