"""Which arithmetic a law takes: the binary where it is, numpy where it is not or is left out."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from aff_runtime.core.compiled.binary import VARIABLE, arithmetic_name, chosen, holding, using
from tests.aff_runtime.core.shape_site import Rig

BLOCKED = "import sys; sys.modules['aff_runtime.core.compiled._arithmetic'] = None; "
NAME = "from aff_runtime.core.compiled.binary import arithmetic_name; print(arithmetic_name())"


def said(code: str, **environment: str) -> str:
    """Return what another Python prints."""
    known = {key: value for key, value in os.environ.items() if key != VARIABLE}
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**known, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def test_numpy_works_where_no_binary_was_built():
    assert said(BLOCKED + NAME) == "numpy"


def test_a_binary_is_left_out_when_asked():
    assert said(NAME, **{VARIABLE: "numpy"}) == "numpy"


@pytest.mark.skipif(chosen() is None, reason="no binary was built")
def test_a_binary_is_taken_where_it_is():
    assert said(NAME) == "compiled"


def test_the_version_says_which_one_works():
    code = BLOCKED + "from aff_runtime.cli.main import main; main(['--version'])"
    assert said(code).endswith(", law by numpy")


def test_a_law_keeps_the_arithmetic_it_was_made_with():
    with using(None):
        assert (chosen(), arithmetic_name(), holding()) == (None, "numpy", None)
        law = Rig().law
    assert law.filter._compiled is None
    assert law.basis._held is None
