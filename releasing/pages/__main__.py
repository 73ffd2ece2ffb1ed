"""``make site``: the documents as a site that asks no other host; a broken link fails."""

from __future__ import annotations

import argparse
import logging
import os
import sys
from pathlib import Path

from releasing.commands import ROOT

SITE = ROOT / "out" / "site"
MISSING = "mkdocs: not found; `make site` installs it, or pip install -e '.[docs]'"


def build(out: Path) -> int:
    """Build the site into a folder; return the exit code."""
    os.environ.setdefault("NO_MKDOCS_2_WARNING", "1")  # of another program's future
    try:
        from mkdocs.commands.build import build as build_pages  # noqa: PLC0415, the extra `docs`
        from mkdocs.config import load_config  # noqa: PLC0415
        from mkdocs.exceptions import Abort, ConfigurationError  # noqa: PLC0415
    except ImportError:
        print(MISSING, file=sys.stderr)
        return 2
    said = logging.StreamHandler()
    said.setLevel(logging.WARNING)
    logging.getLogger("mkdocs").addHandler(said)
    try:
        config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(out), strict=True)
        config.plugins.on_startup(command="build", dirty=False)
        build_pages(config)
    except (Abort, ConfigurationError) as error:
        print(f"site: {error}", file=sys.stderr)
        return 1
    return 0


def main() -> int:
    """Build the site."""
    parser = argparse.ArgumentParser(prog="python -m releasing.pages", description=__doc__)
    parser.add_argument("--out", type=Path, default=SITE, help="folder (default out/site)")
    out: Path = parser.parse_args().out
    code = build(out.resolve())
    if code == 0:
        print(f"site: open {out / 'index.html'} in a browser")
    return code


if __name__ == "__main__":
    sys.exit(main())
