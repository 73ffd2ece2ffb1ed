"""How long the disk bound of the records holds: columns, cycle and size of a value."""

from __future__ import annotations

from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.config.models import Site
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.loop.record import record_columns

BYTES_PER_VALUE = 2.8
"""Of a compressed segment while a correction goes out: 2.74 to 2.83, measured on segments of 179
to 193 columns over Modbus and CAN. Where nothing moves it is 1.7 to 1.9."""
DAY_S = 86_400.0


def record_line(site: Site) -> str:
    """Return in words how long ``recording.max_MB`` holds, and what a day takes."""
    columns = record_width(site)
    bytes_per_s = columns * BYTES_PER_VALUE / site.cycle_s
    bound_MB, day_MB = site.recording.max_MB, 1e-6 * DAY_S * bytes_per_s
    held_h = bound_MB * 1e6 / bytes_per_s / 3600.0
    row = f"{columns} columns at {site.line.cycle_ms:g} ms"
    return (
        f"record: {bound_MB:g} MB (recording.max_MB) hold {held_h:.1f} h of a running correction "
        f"({row}); a day takes {float(f'{day_MB:.2g}'):g} MB"
    )


def record_width(site: Site) -> int:
    """Return the columns of a record once every actuator has its response.

    Which law runs, and so its columns, hangs on there being a response, not on its numbers: the
    one that stands in here is flat.
    """
    flat = [
        ResponsePoint(
            frequency_Hz=frequency_Hz, gain=1.0, phase_rad=0.0, relative_error=0.01, coherence=1.0
        )
        for frequency_Hz in (0.1, 10.0)
    ]
    texts, taps = {}, {}
    for name, actuator in site.actuators.items():
        about = Provenance(actuator=name, signal=actuator.error.signal)
        texts[name] = Response(points=flat, delay_s=0.0, provenance=about).to_json()
        if actuator.uses_shape:
            taps[name] = (1.0,)
    law = controller_of(site, texts, taps).telemetry_names()
    return len(record_columns(tuple(site.gateway.read.channels), tuple(site.actuators), law))
