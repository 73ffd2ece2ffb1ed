import json
import socket
import threading

import pytest

from sim_plant.cli.main import main
from tests.sim_plant.servers.served import served

pytestmark = pytest.mark.wire


def test_a_command_reaches_the_served_plant_and_its_answer_is_shown(tmp_path, capsys):
    path = tmp_path / "plant.sock"
    with served(control=path) as plant:
        assert main(["tell", str(path), "set", "tension_ref_N", "75"]) == 0
        answer = json.loads(capsys.readouterr().out)
        assert answer["ok"]
        assert answer["time_s"] <= plant.service.plant.time_s
        assert plant.service.plant._inputs["tension_ref_N"] == 75.0


def test_what_the_plant_refuses_is_an_error_of_the_command(tmp_path, capsys):
    path = tmp_path / "plant.sock"
    with served(control=path):
        assert main(["tell", str(path), "roll"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "no rolls that can be exchanged" in err


def test_a_socket_that_nobody_serves_is_named_with_what_to_do(tmp_path, capsys):
    path = tmp_path / "none.sock"
    assert main(["tell", str(path), "status"]) == 2
    assert f"no plant answers at {path}" in capsys.readouterr().err


def test_an_end_without_an_answer_is_no_traceback(tmp_path, capsys):
    path = tmp_path / "mute.sock"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as server:
        server.bind(str(path))
        server.listen()

        def hang_up():
            server.accept()[0].close()

        thread = threading.Thread(target=hang_up)
        thread.start()
        assert main(["tell", str(path), "status"]) == 2
        thread.join(10.0)
    assert f"no plant answers at {path}" in capsys.readouterr().err
