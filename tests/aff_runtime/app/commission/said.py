"""What the commissioner says, as a screen finds it on the wire."""

import json

from aff_runtime.app.commission.link.answers import encode


def plain(answer):
    """Return an answer as plain values."""
    return json.loads(encode(answer))
