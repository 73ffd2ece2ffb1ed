"""A bill of materials says what is in a release, and nothing of the folder it was made in."""

from __future__ import annotations

import json

from releasing.materials import part_of


def whole(folder: str) -> dict[str, object]:
    """Return what is said of an environment whose wheel came from a folder."""
    wheel = {"type": "distribution", "url": f"file://{folder}/aff_runtime-0.1.0-py3-none-any.whl"}
    home = {"type": "website", "url": "https://example.org/aff"}
    product = {"name": "aff-runtime", "bom-ref": "aff", "externalReferences": [wheel, home]}
    other = {"name": "numpy", "bom-ref": "numpy", "externalReferences": [home]}
    return {"metadata": {}, "components": [product, other], "dependencies": []}


def test_two_bills_of_one_release_are_the_same_wherever_it_was_made() -> None:
    one, other = (part_of(whole(f"/tmp/tmp{name}/release"), "gateway") for name in "ab")
    assert json.dumps(one) == json.dumps(other)
    references = one["metadata"]["component"]["externalReferences"]
    assert [row["url"] for row in references] == [
        "file:aff_runtime-0.1.0-py3-none-any.whl",
        "https://example.org/aff",
    ]
    assert [item["name"] for item in one["components"]] == ["numpy"]
