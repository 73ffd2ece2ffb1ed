"""Rows of a run folder as the recorder lays them down."""

import gzip
import json


def write_rows(run, lines, columns):
    """Write a run's facts and its first segment into the folder ``run``."""
    (run / "run.yaml").write_text(json.dumps({"columns": list(columns), "name": "a line"}))
    with gzip.open(run / "signals-0001.csv.gz", "wt", compresslevel=1) as file:
        file.write("\n".join([",".join(columns), *lines, ""]))
