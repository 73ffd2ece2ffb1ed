"""Samples in the text format of Prometheus, for a file and for a web server alike.

Written here, as a gateway without the screen has no package of Prometheus. Neither the service nor
its control process comes here.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TypeAlias

from aff_runtime.app.report.metrics.catalogue import BY_NAME, CATALOGUE, INFO, Metric
from aff_runtime.app.report.metrics.readings import MetricHistogram, Sample
from aff_runtime.base.errors import AffError

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
LACKS = "the package prometheus_client is needed: install aff-runtime[hmi]"
_ESCAPED = str.maketrans({"\\": r"\\", "\n": r"\n", '"': r"\""})


Labels: TypeAlias = tuple[tuple[str, str], ...]


def exposition(
    samples: Sequence[Sample | MetricHistogram], *, line: str = "", has_process: bool = False
) -> str:
    """Return samples in the Prometheus text format, whose type is ``CONTENT_TYPE``.

    Parameters
    ----------
    line : value of a label ``line`` on every sample; without it there is no such label.
    has_process : with what this process uses, by prometheus_client's own names ``process_...``.

    Raises
    ------
    AffError
        When the process is asked for and prometheus_client is not installed.
    """
    rows: dict[str, list[str]] = defaultdict(list)
    whose = (("line", line),) if line else ()
    for sample in samples:
        if isinstance(sample, MetricHistogram):
            rows[sample.metric] += _of_histogram(sample, whose)
        else:
            rows[sample.metric] += _of_sample(sample, whose)
    said = [metric for metric in CATALOGUE if metric.name in rows]
    text = "".join(_head(metric) + "".join(rows[metric.name]) for metric in said)
    return text + (_of_process() if has_process else "")


def _head(metric: Metric) -> str:
    kind = "gauge" if metric.kind == INFO else metric.kind  # the format has no kind for facts
    return f"# HELP {metric.name} {metric.text}\n# TYPE {metric.name} {kind}\n"


def _of_sample(sample: Sample, whose: Labels) -> Iterator[str]:
    names = BY_NAME[sample.metric].labels
    yield _row(sample.metric, (*whose, *zip(names, sample.labels, strict=True)), sample.value)


def _of_histogram(histogram: MetricHistogram, whose: Labels) -> Iterator[str]:
    for edge, count in histogram.buckets:
        yield _row(f"{histogram.metric}_bucket", (*whose, ("le", _number(edge))), count)
    yield _row(f"{histogram.metric}_count", whose, histogram.buckets[-1][1])
    yield _row(f"{histogram.metric}_sum", whose, histogram.total)


def _row(name: str, labels: Labels, value: float) -> str:
    inside = ",".join(f'{label}="{text.translate(_ESCAPED)}"' for label, text in labels)
    return f"{name}{{{inside}}} {_number(value)}\n" if inside else f"{name} {_number(value)}\n"


def _number(value: float) -> str:
    """Return a number as Go reads it, its infinity included."""
    if math.isinf(value):
        return "+Inf" if value > 0.0 else "-Inf"
    return "NaN" if math.isnan(value) else repr(float(value))


def _of_process() -> str:
    try:
        from prometheus_client import ProcessCollector  # noqa: PLC0415  not the gateway's own
        from prometheus_client.exposition import generate_latest  # noqa: PLC0415
    except ImportError:
        raise AffError(LACKS) from None
    return generate_latest(ProcessCollector(registry=None)).decode()
