"""Samples in the text format of Prometheus, for a file and for a web server alike.

Neither the service nor its control process comes here: they know no package of a web server.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from aff_runtime.app.report.metrics.catalogue import CATALOGUE, COUNTER, HISTOGRAM, INFO
from aff_runtime.app.report.metrics.readings import Sample, Spread
from aff_runtime.base.errors import AffError

if TYPE_CHECKING:
    from prometheus_client.metrics_core import Metric

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
LACKS = "the package prometheus_client is needed: install aff-runtime[hmi]"


def exposition(samples: Sequence[Sample | Spread], *, has_process: bool = False) -> str:
    """Return samples in the Prometheus text format, whose type is ``CONTENT_TYPE``.

    Parameters
    ----------
    has_process : with what this process uses, by prometheus_client's own names ``process_...``.

    Raises
    ------
    AffError
        When prometheus_client is not installed.
    """
    try:
        from prometheus_client import ProcessCollector  # noqa: PLC0415  not the gateway's own
        from prometheus_client import exposition as writer  # noqa: PLC0415
    except ImportError:
        raise AffError(LACKS) from None
    text = writer.generate_latest(_Collected(samples))
    if has_process:
        text += writer.generate_latest(ProcessCollector(registry=None))
    return text.decode()


class _Collected:
    """Samples as prometheus_client collects them."""

    def __init__(self, samples: Sequence[Sample | Spread]) -> None:
        self._samples = [one for one in samples if isinstance(one, Sample)]
        self._spreads = {one.metric: one for one in samples if isinstance(one, Spread)}

    def collect(self) -> Iterator[Metric]:
        """Yield every family that has a sample."""
        from prometheus_client.metrics_core import (  # noqa: PLC0415
            CounterMetricFamily,
            GaugeMetricFamily,
            HistogramMetricFamily,
            InfoMetricFamily,
        )

        by_name: dict[str, list[Sample]] = defaultdict(list)
        for sample in self._samples:
            by_name[sample.metric].append(sample)
        for metric in CATALOGUE:
            samples = by_name.get(metric.name, [])
            if samples and metric.kind == INFO:
                info = InfoMetricFamily(metric.name.removesuffix("_info"), metric.text)
                for sample in samples:
                    info.add_metric([], dict(zip(metric.labels, sample.labels, strict=True)))
                yield info
            elif metric.kind == HISTOGRAM and metric.name in self._spreads:
                spread = HistogramMetricFamily(metric.name, metric.text, labels=metric.labels)
                one = self._spreads[metric.name]
                edges = [(_edge(edge), count) for edge, count in one.buckets]
                spread.add_metric((), edges, one.total)
                yield spread
            elif samples:
                kind = CounterMetricFamily if metric.kind == COUNTER else GaugeMetricFamily
                family = kind(metric.name, metric.text, labels=metric.labels)
                for sample in samples:
                    family.add_metric(sample.labels, sample.value)
                yield family


def _edge(edge: float) -> str:
    return "+Inf" if math.isinf(edge) else repr(edge)
