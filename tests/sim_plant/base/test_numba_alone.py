import subprocess
import sys


def test_numba_looks_for_no_blas_until_compiled_code_wants_one():
    """The search takes longer than all else that the kernel needs of numba at its start."""
    code = (
        "import sys\n"
        "covered = 'coverage' in sys.modules\n"
        "from sim_plant.base.numba_alone import numba\n"
        "from numba.np import linalg\n"
        "found = ['scipy.linalg' in sys.modules, covered != ('coverage' in sys.modules)]\n"
        "linalg.ensure_blas()\n"
        "print([*found, 'scipy.linalg' in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.strip() == "[False, False, True]"
