"""The block of a real compiler takes the cases of the interpreter, and stands in as the PLC."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import pytest

from tests.deploy.compiled_plc import CompiledPlc
from tests.deploy.st_compilers import CompiledBlock, StCompiler, found, why_not

if why_not():
    pytest.skip(why_not(), allow_module_level=True)

from tests.deploy import test_aff_gateway_st as cases
from tests.lockstep import test_faults, test_operator
from tests.lockstep.conftest import responses
from tests.matrix import test_matrix
from tests.matrix.cells import Cell, cells, judge

NEW = "tests.deploy.test_aff_gateway_st.StMachine"
PLACES = ("tests.matrix.bench.Plc", "tests.lockstep.bench.Plc")
BY_ITSELF = {"test_the_file_is_one_block_of_the_statements_that_run_here"}  # of the interpreter


@pytest.fixture(scope="module", params=list(found()), ids=lambda one: one.name, autouse=True)
def compiler(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[StCompiler]:
    """Put the compiled block in the place of the interpreter and of the simulated PLC."""
    one: StCompiler = request.param
    folder = tmp_path_factory.mktemp(one.name)
    shipped = partial(CompiledBlock, one, cases.BLOCK, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(NEW, lambda path: CompiledBlock(one, path, folder))
        for place in PLACES:
            patch.setattr(place, partial(CompiledPlc, shipped))
        yield one


def _taken() -> Iterator[tuple[str, object]]:
    """Yield the cases of the interpreter and of the lockstep benches, with their fixtures."""
    for module in (cases, test_faults, test_operator):
        for name, thing in vars(module).items():
            if name.startswith("test_") and name not in BY_ITSELF:
                yield name, thing
    yield from ((name, getattr(test_faults, name)) for name in ("working", "bench"))
    yield "responses", responses


globals().update(_taken())


@pytest.mark.parametrize("cell", list(test_matrix.covering()), ids=str)
def test_a_cell_reacts_with_the_compiled_block_as_the_plc(cell: Cell) -> None:
    assert judge(cell) == ""


@pytest.mark.long
@pytest.mark.timeout(600)
def test_every_cell_reacts_with_the_compiled_block_as_the_plc() -> None:
    wrong = {str(cell): judge(cell) for cell in cells()}
    print(f"{len(wrong)} cells")
    assert {cell: words for cell, words in wrong.items() if words} == {}
