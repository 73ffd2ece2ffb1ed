"""Parameter records for tests, without a check of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site

CONFIG = Path(__file__).parents[1] / "config"
EUCLID = load_site(CONFIG / "euclid.yaml")


def record_of(site: Site = EUCLID, **given: Any) -> ParameterRecord:
    """Return the record of ``site``; what is not given is empty, the revisions are made up."""
    return ParameterRecord(**{"site": site, "site_hash": "5e", "config_hash": "abc"} | given)
