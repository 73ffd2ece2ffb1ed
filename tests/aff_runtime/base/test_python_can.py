"""What a process that speaks CAN loads, where all the extras are installed."""

import importlib.util
import subprocess
import sys

import pytest

SPEAKING_CAN = """
import sys
import aff_runtime.fieldbus.can_catalogue
import sim_plant.pytest_plugin.can_client
import sim_plant.servers.can_catalogue
print(*sorted({"asammdf", "pandas", "pyarrow"} & set(sys.modules)))
import asammdf
print(asammdf.MDF.__name__)
"""


@pytest.mark.skipif(
    importlib.util.find_spec("asammdf") is None, reason="asammdf (extra records) is not installed"
)
def test_a_bus_loads_no_tables_and_files_and_who_needs_them_later_has_them():
    child = subprocess.run(
        [sys.executable, "-c", SPEAKING_CAN], capture_output=True, text=True, check=False
    )
    assert child.stderr == ""
    assert child.stdout.split("\n")[:2] == ["", "MDF"]
