from pathlib import Path

import pytest

from tests.sim_plant.line.lines import ROOT


@pytest.fixture(scope="session")
def line_records() -> Path:
    """The folder of the line records, with their declarations and labels."""
    return ROOT / "data" / "lines"
