"""What a probe measured reaches the operator as a table."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from aff_runtime.app.link.answers import Answer, KeptResponse, ProbeDone
from aff_runtime.app.link.messages import Probed
from aff_runtime.app.link.replies import ProbeResult
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import RequestSocket
from aff_runtime.app.supervisor.probe_session import ProbeSession
from aff_runtime.cli.probe import bounds, table, unsure
from aff_runtime.config.loader import load_site
from aff_runtime.core.response import Response
from tests.aff_runtime.core.plants import measured
from tests.parameter_records import record_of

SITE = Path(__file__).parents[3] / "config" / "euclid_blocks.yaml"


def test_a_result_passes_the_socket_and_is_shown_as_measured(tmp_path: Path) -> None:
    response = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    result = ProbeResult(
        actuator="unwind", sign=1, remarks=("short",), delay_s=0.05, text=response.to_json()
    )
    answers: list[Answer] = []
    recorded: list[tuple[str, Any]] = []
    processes = SimpleNamespace(
        parameters=record_of(response_files={"unwind": tmp_path / "unwind.json"}),
        probed=SimpleNamespace(add=lambda *_: None),
        note=lambda *_: None,
        keep_response=lambda actuator, text: recorded.append((actuator, json.loads(text))),
    )
    edits = SimpleNamespace(look_again=lambda: None, is_busy=False)
    session = ProbeSession(processes, edits, answers.append)  # type: ignore[arg-type]
    session.finish(Probed(results=(result,)))
    assert session.has_answered()
    ((actuator, kept),) = recorded
    assert (actuator, kept["units"]["gain"]) == ("unwind", "N/(m/s)")
    assert Response.from_json(json.dumps(kept)).points == response.points

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

    rows = list(table(told, "N/(m/s)", "m/s"))
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
    more = " ".join(unsure(noisy, "probe.bound_m_s", 0.02, may_be_louder=True))
    assert "--louder" in more
    assert "0.02" not in more


def test_bounds_are_said_before_the_first_tone(tmp_path: Path) -> None:
    text = SITE.read_text()
    site = tmp_path / "site.yaml"
    site.write_text(text.replace("  amplitude_m_s: 0.008\n", ""))
    chosen = list(bounds(load_site(site), ["unwind"]))
    assert chosen == [
        "unwind: at most 0.02 m/s, chosen from the noise; "
        "it ends where unwind_tension_N moves by 10% of what it is"
    ]
    site.write_text(
        text.replace("  amplitude_m_s: 0.008\n", "  bound_N: 3\n  bound_m_s: 0.2 cm/s\n")
    )
    (narrow,) = bounds(load_site(site), ["unwind"])
    assert narrow.startswith("unwind: at most 0.002 m/s")
    assert narrow.endswith("it ends where unwind_tension_N moves by 3 N")
    assert list(bounds(load_site(SITE), ["unwind"])) == ["unwind: 0.008 m/s"]


def test_a_second_probe_says_how_far_it_is_from_the_first(tmp_path: Path) -> None:
    first = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    about = replace(first.provenance, amplitude=0.004, repeat_sigmas=1.25)
    again = Response(points=first.points, delay_s=0.0, provenance=about)
    result = ProbeResult(actuator="unwind", sign=1, remarks=(), delay_s=0.0, text=again.to_json())
    rows = list(table(KeptResponse(result=result, file=tmp_path), "N/(m/s)", "m/s"))
    assert rows[1] == "  sent: 0.004 m/s at most"
    assert rows[2].startswith("  against the probe before: 1.25 of the stated errors apart")
