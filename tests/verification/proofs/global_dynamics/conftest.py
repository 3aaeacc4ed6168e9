"""A fixture for tests of enclosures of all orbits."""

import numpy as np
import pytest


@pytest.fixture(scope="session")
def tight():
    """A test whether a ball contains all sampled values and is hardly wider than their range."""

    def holds(ball, values, factor=1.1, slack=1e-12):
        low, high, width = np.min(values), np.max(values), np.ptp(values)
        at, end = float(np.ravel(ball.lower())[0]), float(np.ravel(ball.upper())[0])
        return at <= low + slack and high - slack <= end and end - at <= factor * width + 4 * slack

    return holds
