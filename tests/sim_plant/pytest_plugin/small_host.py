"""The host of the plugin with a line that needs no compiler: processes and sockets are real."""

import sys
from pathlib import Path

from tests import quick_yaml
from tests.sim_plant.servers.no_kernel import opened_by


def small_line(path, **_):
    """Return a line of which nothing is as the file says but its sample time."""
    from tests.sim_plant.servers.fake_line import FakeLine

    return FakeLine(
        quick_yaml.safe_load(Path(path).read_text("utf-8")).get("sample_time_s", 0.005)
    )


if __name__ == "__main__":
    opened_by(small_line)
    from sim_plant.pytest_plugin import plant_host

    plant_host.obey(sys.stdin, plant_host.answers_alone())
