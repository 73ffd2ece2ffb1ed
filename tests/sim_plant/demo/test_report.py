"""What the page of a demo is made from."""

from __future__ import annotations

import gzip
from pathlib import Path

from sim_plant.demo.report import runtime_columns


def test_the_segments_of_a_run_are_joined_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for number in (9998, 9999, 10_000, 10_001):
        with gzip.open(tmp_path / f"signals-{number}.csv.gz", "wt") as file:
            file.write(f"time_s,speed_m_s\n{number}.0,1.0\n{number}.5,1.0\n")
    times = runtime_columns(tmp_path)["time_s"].tolist()
    assert times == [9998 + 0.5 * k for k in range(8)]
