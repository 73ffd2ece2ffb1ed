"""Every number that decides says its unit, what it decides and what it was set on."""

import ast
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.criteria.criterion import NOT_RECORDED, reasons
from tests.each_case import each_case
from tests.house.trees import tree_of

REFINE = Path(__file__).parents[4] / "sim_plant/refine"
REASONS = list(reasons(CRITERIA))
NOT_WRITTEN_DOWN = 142


@each_case("reason", REASONS, ids=lambda r: r.name)
def test_a_criterion_says_its_unit_its_meaning_and_its_origin(reason):
    assert reason.unit.strip()
    assert len(reason.meaning) > 8
    assert reason.origin.strip()


def test_criteria_whose_origin_nobody_wrote_down_only_become_fewer():
    """What a new one was set on is known when it is written."""
    origins = [reason.origin for reason in REASONS]
    assert sum(origin.startswith(NOT_RECORDED) for origin in origins) <= NOT_WRITTEN_DOWN


def test_no_criterion_can_be_changed_while_a_run_is_on():
    with pytest.raises(FrozenInstanceError):
        CRITERIA.search.acceptance.score = 1.0
    with pytest.raises(TypeError):
        CRITERIA.model.default_tolerance["web.EA_N"] = 1.0


def test_the_table_has_every_room_and_is_in_order_of_the_rooms():
    rooms = list(dict.fromkeys(r.name.split(".")[0] for r in REASONS))
    assert rooms[0] == "records"
    assert rooms == list(CRITERIA.__dataclass_fields__)


def read_attributes():
    """Return the fields of criteria that are read somewhere in refine, as attribute names."""
    return {
        node.attr
        for path in REFINE.rglob("*.py")
        if "criteria" not in path.relative_to(REFINE).parts
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Attribute)
    }


def test_no_criterion_is_left_that_decides_nothing():
    names = {r.name.rsplit(".", 1)[-1] for r in REASONS}
    assert names <= read_attributes()
