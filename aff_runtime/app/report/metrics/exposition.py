"""Samples in the text format of Prometheus, for a file and for a web server alike.

Neither the service nor its control process comes here: they know no package of a web server.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from aff_runtime.app.report.metrics.catalogue import CATALOGUE, COUNTER, INFO
from aff_runtime.app.report.metrics.readings import Sample
from aff_runtime.base.errors import AffError

if TYPE_CHECKING:
    from prometheus_client.metrics_core import Metric

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
LACKS = "the package prometheus_client is needed: install aff-runtime[hmi]"


def exposition(samples: Sequence[Sample]) -> str:
    """Return samples in the Prometheus text format, whose type is ``CONTENT_TYPE``.

    Raises
    ------
    AffError
        When prometheus_client is not installed.
    """
    try:
        from prometheus_client import exposition as writer  # noqa: PLC0415  not the gateway's own
    except ImportError:
        raise AffError(LACKS) from None
    return writer.generate_latest(_Collected(samples)).decode()


class _Collected:
    """Samples as prometheus_client collects them."""

    def __init__(self, samples: Sequence[Sample]) -> None:
        self._samples = samples

    def collect(self) -> Iterator[Metric]:
        """Yield every family that has a sample."""
        from prometheus_client.metrics_core import (  # noqa: PLC0415
            CounterMetricFamily,
            GaugeMetricFamily,
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
            elif samples:
                kind = CounterMetricFamily if metric.kind == COUNTER else GaugeMetricFamily
                family = kind(metric.name, metric.text, labels=metric.labels)
                for sample in samples:
                    family.add_metric(sample.labels, sample.value)
                yield family
