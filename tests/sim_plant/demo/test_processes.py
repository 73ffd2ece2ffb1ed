"""Commands that a demo gives to the service."""

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.processes import Bench, runtime_command

pytestmark = pytest.mark.processes


def test_a_command_that_is_not_answered_in_time_says_where_to_look(tmp_path):
    bench = Bench(folder=tmp_path, site=tmp_path / "site.yaml", plant_arguments=())
    with pytest.raises(PlantError, match=r"status: no answer within 0.01 s.*runtime\.log says"):
        runtime_command(bench, "status", patience_s=0.01)
