# SPDX-License-Identifier: MIT
import os
import subprocess

import matplotlib
import pytest

matplotlib.use("Agg")


@pytest.fixture
def program():
    """Runs the program. Returns the completed process."""

    def run(*arguments):
        return subprocess.run([os.environ["CONTACTSPLINE_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)

    return run
