"""How many drawn inputs a test looks at: few in the quick suite, many in `make test-long`."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import HealthCheck, settings


def drawn(quick: int, long: int, without: Sequence[HealthCheck] = ()) -> settings:
    """Return the settings of a test whose inputs take milliseconds each.

    Parameters
    ----------
    quick, long : inputs in `make test`, and in `make test-long` (hypothesis' profile ``long``).
    without : health checks that do not hold for it, beside those of the suite.
    """
    is_long = settings.get_current_profile_name() == "long"
    suppressed = [HealthCheck.too_slow, *without]
    most = long if is_long else quick
    return settings(max_examples=most, deadline=None, suppress_health_check=suppressed)
