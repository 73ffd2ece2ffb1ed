"""The host of the plugin with a line that needs no compiler: processes and sockets are real."""

import sys

from sim_plant import line
from tests.sim_plant.servers.fake_line import FakeLine

line.open_line = lambda path, **_: FakeLine(0.005)

from sim_plant.pytest_plugin import plant_host  # noqa: E402 (takes the name from the line above)

if __name__ == "__main__":
    plant_host.obey(sys.stdin, sys.stdout)
