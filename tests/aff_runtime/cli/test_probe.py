"""What a probe measured reaches the operator as a table."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from aff_runtime.app.link.answers import Answer, ProbeDone
from aff_runtime.app.link.messages import Probed
from aff_runtime.app.link.replies import ProbeResult
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import RequestSocket
from aff_runtime.app.supervisor.probe_session import ProbeSession
from aff_runtime.cli.probe import table, unsure
from aff_runtime.core.response import Response
from tests.aff_runtime.core.plants import measured
from tests.parameter_records import record_of


def test_a_result_passes_the_socket_and_is_shown_as_measured(tmp_path: Path) -> None:
    response = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    result = ProbeResult(
        actuator="unwind", sign=1, remarks=("short",), delay_s=0.05, text=response.to_json()
    )
    answers: list[Answer] = []
    processes = SimpleNamespace(
        parameters=record_of(response_files={"unwind": tmp_path / "unwind.json"}),
        probed=SimpleNamespace(add=lambda *_: None),
        note=lambda *_: None,
    )
    edits = SimpleNamespace(look_again=lambda: None, is_busy=False)
    session = ProbeSession(processes, edits, answers.append)  # type: ignore[arg-type]
    session.finish(Probed(results=(result,)))
    assert session.has_answered()

    (tmp_path / "run").mkdir(mode=0o700)
    service = RequestSocket(tmp_path / "run" / "control.sock")
    client = ServiceClient(tmp_path / "run" / "control.sock")
    caller = service.accept()
    assert caller is not None
    caller.send(answers[0])
    said = client.ask("probe")
    (told,) = ProbeDone.from_json(said).results
    client.close()
    service.close()

    rows = list(table(told, "N/(m/s)"))
    assert rows[0] == "unwind: sign +1, delay 50 ms"
    assert [row.split()[:3] for row in rows[2:4]] == [
        ["0.500", "250", "0.0"],
        ["1.000", "250", "0.0"],
    ]
    assert rows[4:] == ["  remark: short", f"  kept in {tmp_path / 'unwind.json'}"]
    assert json.loads((tmp_path / "unwind.json").read_text()) == said["results"][0]["response"]


def test_frequencies_that_were_heard_badly_name_the_amplitude_that_would_do() -> None:
    """Coherence 0.5: noise as loud as the tones. 0.9 wants a ninth: three times the amplitude."""
    clean = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    assert list(unsure(clean, "probe.amplitude_m_s", 0.0008)) == []
    noisy = Response(
        points=[replace(clean.points[0], coherence=0.5), clean.points[1]],
        delay_s=0.0,
        provenance=clean.provenance,
    )
    said = " ".join(unsure(noisy, "probe.amplitude_m_s", 0.0008))
    assert said.startswith("  1 of 2 frequencies are not sure")
    assert "probe again with probe.amplitude_m_s: 0.003 (was 0.0008)" in said
    assert "probe.duration_s" in said
