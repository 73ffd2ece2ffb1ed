"""A dict of anything is met where JSON or YAML begins and ends, and nowhere else."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[2]
OTHER_NAME = re.compile(r"^\w+(: TypeAlias)? = (dict|Mapping)\[(str, Any|str, object|Any)", re.M)
ANYTHING = re.compile(r"(dict|Mapping)\[str, (Any|object)\]|dict\[Any")
MOST = 40
EDGES = {
    "aff_runtime/app/check/result.py": "JSON of the check",
    "aff_runtime/app/commission/messages.py": "JSON of the commissioner, called Told",
    "aff_runtime/app/link/answers.py": "JSON of the request socket",
    "aff_runtime/app/link/parameter_record.py": "JSON of the check and the link",
    "aff_runtime/app/link/request_client.py": "JSON of the request socket",
    "aff_runtime/app/link/requests.py": "JSON of the request socket",
    "aff_runtime/app/report/comparison/page.py": "JSON of a comparison",
    "aff_runtime/app/report/status_answer.py": "JSON of the status",
    "aff_runtime/base/yaml_section.py": "YAML of a run folder",
    "aff_runtime/cli/terminal.py": "JSON for scripts",
    "aff_runtime/config/quantity.py": "keyword arguments of pydantic",
    "aff_runtime/telemetry/header.py": "JSON of the ring, YAML of a run",
    "sim_plant/base/jit.py": "keyword arguments of numba",
    "sim_plant/cli/tell.py": "JSON for scripts",
    "sim_plant/line/declaration.py": "YAML of a line file",
    "sim_plant/pytest_plugin/web_line.py": "JSON of the control socket",
    "sim_plant/refine/records/child.py": "JSON of the record reader",
    "sim_plant/refine/records/in_child.py": "JSON of the record reader",
    "sim_plant/refine/records/run_site.py": "YAML of a run folder",
    "sim_plant/refine/report/aff_block.py": "YAML for a site file",
    "sim_plant/refine/report/amend.py": "YAML of a line file",
    "sim_plant/refine/report/verdict.py": "JSON of the verdict",
    "sim_plant/refine/report/yaml_edit.py": "YAML of a line file",
    "sim_plant/refine/without_line/verdict.py": "JSON of the verdict",
    "sim_plant/reproduce/gallery.py": "JSON of the gallery",
    "sim_plant/servers/answers.py": "JSON of the control socket",
    "sim_plant/servers/control_client.py": "JSON of the control socket",
}


def found() -> Counter[str]:
    """Return how often each product file says it."""
    counts: Counter[str] = Counter()
    for half in ("aff_runtime", "sim_plant", "aff_hmi"):
        for path in (ROOT / half).rglob("*.py"):
            counts[str(path.relative_to(ROOT))] += len(
                ANYTHING.findall(path.read_text(encoding="utf-8"))
            )
    return +counts


def test_a_dict_of_anything_is_an_edge() -> None:
    assert set(found()) == set(EDGES)


def test_there_are_few() -> None:
    assert found().total() <= MOST


def test_one_file_alone_has_another_name_for_it() -> None:
    files = {file for file in found() if OTHER_NAME.search((ROOT / file).read_text("utf-8"))}
    assert files == {"aff_runtime/app/commission/messages.py"}
