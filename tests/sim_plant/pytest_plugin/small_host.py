"""The host of the plugin with a line that needs no compiler: processes and sockets are real."""

import sys
from pathlib import Path

from sim_plant import line
from tests import quick_yaml
from tests.sim_plant.servers.fake_line import FakeLine


def small_line(path, **_):
    """Return a line of which nothing is as the file says but its sample time."""
    return FakeLine(
        quick_yaml.safe_load(Path(path).read_text("utf-8")).get("sample_time_s", 0.005)
    )


line.open_line = small_line

from sim_plant.pytest_plugin import plant_host  # noqa: E402 (takes the name from above)

if __name__ == "__main__":
    plant_host.obey(sys.stdin, plant_host.answers_alone())
