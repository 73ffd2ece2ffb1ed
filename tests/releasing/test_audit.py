"""What the audit says, and its exit codes, of what pip-audit answers."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from releasing import audit

CLEAN = {"name": "numpy", "version": "2.4.4", "vulns": []}
BAD = {
    "name": "pyyaml",
    "version": "5.3",
    "vulns": [{"id": "PYSEC-2021-142", "fix_versions": ["5.4"]}],
}
UNSEEN = {"name": "pydantic", "skip_reason": "Dependency not found on PyPI"}


@pytest.mark.parametrize(
    ("rows", "code", "says"),
    [
        ([CLEAN], 0, "1 packages, 0 known vulnerabilities, 0 not looked up"),
        ([CLEAN, BAD], 1, "pyyaml 5.3  PYSEC-2021-142  fixed in: 5.4"),
        ([BAD, UNSEEN], 1, "of these nothing is known: pydantic (Dependency not found"),
        ([CLEAN, UNSEEN], 3, "of these nothing is known: pydantic (Dependency not found"),
        (
            [UNSEEN, UNSEEN | {"name": "numpy"}],
            3,
            "not audited: the vulnerability data could not be had",
        ),
        (None, 3, "not audited: the vulnerability data could not be had (no network)"),
    ],
)
def test_an_audit_is_clean_only_where_every_package_was_looked_up(
    rows: list[dict[str, object]] | None,
    code: int,
    says: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    answer = f"print({json.dumps({'dependencies': rows})!r})"
    program = answer if rows is not None else "import sys; sys.exit('no network')"
    fake = tmp_path / "pip-audit"
    fake.write_text(f"#!{sys.executable}\n{program}\n", encoding="utf-8")
    fake.chmod(0o755)
    monkeypatch.setattr(audit, "tool", lambda _: str(fake))
    assert audit.main() == code
    assert says in capsys.readouterr().out
