"""``python -m releasing.audit``: known vulnerabilities of the locked packages (pip-audit).

Exit codes: 0 none known, 1 some, 3 the data could not be reached, of some package or of all.
"""

from __future__ import annotations

import json
import subprocess
import sys

from releasing.commands import ROOT, ReleaseError, tool
from releasing.lock import BUILD, EXTRAS, LOCKS

PATIENCE_S = 300.0


def audit() -> int:
    """Print what is known of the packages of every lock; return the exit code."""
    locks = [word for name in (*EXTRAS, BUILD) for word in ("-r", str(LOCKS / f"{name}.txt"))]
    fixed = ["--disable-pip", "--require-hashes", "--progress-spinner", "off", "--format", "json"]
    command = [tool("pip-audit"), *fixed, *locks]
    try:
        done = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=PATIENCE_S
        )
        rows = json.loads(done.stdout)["dependencies"]
    except subprocess.TimeoutExpired:
        return _not_audited(f"no answer within {PATIENCE_S:.0f} s")
    except (ValueError, KeyError):
        return _not_audited((done.stderr.strip().splitlines() or ["pip-audit said nothing"])[-1])
    unseen = {row["name"]: row["skip_reason"] for row in rows if "skip_reason" in row}
    found = 0
    for row in rows:
        for known in row.get("vulns", ()):
            found += 1
            fixes = ", ".join(known["fix_versions"]) or "none yet"
            print(f"{row['name']} {row['version']}  {known['id']}  fixed in: {fixes}")
    print(f"{len(rows)} packages, {found} known vulnerabilities, {len(unseen)} not looked up")
    if not unseen:
        return 1 if found else 0
    why = next(iter(unseen.values()))
    if len(unseen) == len(rows):
        return _not_audited(why)
    print(f"of these nothing is known: {', '.join(unseen)} ({why[:200]})")
    return 1 if found else 3


def _not_audited(why: str) -> int:
    """Say that nothing is known, and why; return the exit code."""
    print(f"not audited: the vulnerability data could not be had ({why[:200]})")
    print("nothing is known of the packages; say `make audit` again where pypi.org answers itself")
    return 3


def main() -> int:
    """Run the audit."""
    try:
        return audit()
    except ReleaseError as error:
        print(f"make audit: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
