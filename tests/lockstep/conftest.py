from collections.abc import Mapping

import pytest

from aff_runtime.core.response import Response
from tests.lockstep.known_response import known_responses


@pytest.fixture(scope="session")
def responses() -> Mapping[str, Response]:
    """The response of both actuators at 200 FPM."""
    return known_responses()
