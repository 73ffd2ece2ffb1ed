"""The end of a service in the middle of a probe, between real processes: what is said is so.

Of one whose terminal closes, that its zero arrived: ``test_service.py``.
"""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.aff_runtime.app.service_run import ServiceRun
from tests.aff_runtime.app.test_commissioning_kills import Asked

pytestmark = [pytest.mark.wire, pytest.mark.timeout(120)]


# quick, in virtual time: loop/test_last_zero.py; what is said: supervisor/test_end_of_service.py
@pytest.mark.long
def test_a_service_that_stops_while_the_plc_is_silent_claims_no_zero(tmp_path: Path) -> None:
    service = ServiceRun(tmp_path, "--state-dir", "/nowhere")
    try:
        Asked(service)
        service.plc.send_signal(signal.SIGSTOP)
        service.process.terminate()
        assert service.process.wait(20) == 5
        assert service.said("no answer of the PLC says that a zero arrived")
        assert service.said("stopped\n")
        assert not service.said("reached zero")
        assert not service.said("did not end in good order")
    finally:
        service.plc.send_signal(signal.SIGCONT)
        service.close()
