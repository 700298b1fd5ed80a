# SPDX-License-Identifier: MIT
import base64
import io
import os
import re
import subprocess

import matplotlib
import matplotlib.image
import pytest

matplotlib.use("Agg")


@pytest.fixture
def program():
    """Runs the program. Returns the completed process."""

    def run(*arguments):
        return subprocess.run([os.environ["CONTACTSPLINE_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)

    return run


@pytest.fixture
def image_of():
    """Returns the pixels of the figure in an object's _repr_html_()."""

    def pixels(shown):
        found = re.findall(r'<img src="data:image/png;base64,([^"]*)">', shown._repr_html_())
        assert len(found) == 1
        return matplotlib.image.imread(io.BytesIO(base64.b64decode(found[0], validate=True)))

    return pixels
