"""The solver keeps its compiled code between runs."""

from __future__ import annotations

import os
import subprocess
import sys

_SOLVE = """
import numpy as np
from flowtree.matting.solve_alpha import solve_alpha
rgb = np.arange(192, dtype=np.uint8).reshape(8, 8, 3)
print(solve_alpha(rgb, np.full((8, 8), 0.5, np.float32), np.ones((8, 8), np.float32)).sum())
"""


def test_a_second_process_reads_what_the_first_has_compiled(tmp_path):
    said = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", _SOLVE],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        said.append(done.stdout)
    assert list(tmp_path.rglob("*.nbi")), "nothing was kept"
    assert said[0] == said[1]
