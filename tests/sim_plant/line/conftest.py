import os
from pathlib import Path

import pytest

from tests.sim_plant.line.lines import ROOT


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of shared records, or a skip that says where it was looked for."""
    folder = Path(os.environ.get("AFF_SHARED", ROOT.parent / "shared" / "data"))
    if not (folder / "lines" / "labels.yaml").is_file():
        pytest.skip(
            f"no shared records in {folder}; set AFF_SHARED to the folder that holds lines/"
        )
    return folder
