"""``aff-runtime probe``: measure the loop's response with the running service."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from aff_runtime.app.validation import load_record
from aff_runtime.cli.service import connect

MARGIN_S = 40.0


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "probe", parents=[service], help="measure the response while the line runs"
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    parser.add_argument("--actuator", action="append", default=[], metavar="A")
    parser.set_defaults(command=probe)


def probe(options: argparse.Namespace) -> int:
    """Run a probe and print its table."""
    record = load_record(options.site).record or {}
    duration_s = float(record["site"]["probe"]["duration_s"])
    print(f"probing for about {duration_s:.0f} s; `aff-runtime bypass` ends it", flush=True)
    client = connect(options)
    try:
        answer = client.ask("probe", timeout_s=duration_s + MARGIN_S, actuators=options.actuator)
    finally:
        client.close()
    for result in answer["results"]:
        for line in table(result):
            print(line)
    return 0


def table(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield one probed actuator as text."""
    response = json.loads(result["text"])
    yield f"{result['actuator']}: sign {result['sign']:+d}, delay {result['delay_s'] * 1e3:.0f} ms"
    yield "      Hz        |P|   phase deg  error %  coherence"
    for point in response["points"]:
        yield (
            f"{point['frequency_Hz']:8.3f} {point['gain']:10.4g} "
            f"{math.degrees(point['phase_rad']):11.1f} {point['relative_error'] * 100:8.1f} "
            f"{point['coherence']:10.3f}"
        )
    for remark in result["remarks"]:
        yield f"  remark: {remark}"
    yield f"  kept in {result['file']}"
