"""Logs that several tests use."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tempco


@pytest.fixture(scope="session")
def log() -> tempco.Log:
    return tempco.simulate("paper", "calibration", seed=1, rate_hz=0.5)


@pytest.fixture(scope="session")
def held_out() -> tempco.Log:
    return tempco.simulate("paper", "verification", seed=2, rate_hz=0.5)


@pytest.fixture(scope="session")
def unit(log: tempco.Log) -> tempco.Set:
    return tempco.fit(log, "S1", model="composite", report=True)


@pytest.fixture(scope="session")
def columns(log: tempco.Log) -> dict[str, np.ndarray]:
    """The pulse counts of the log, as a logger has them."""
    columns = log.columns()
    counts = {
        f"{name}_pulses": np.round(columns[f"{name}_pulses_per_s"] * log.interval_s)
        for name, _, _ in log.axes
    }
    return {"time_s": columns["time_s"], "temp_c": columns["temp_c"], **counts}


@pytest.fixture(scope="session")
def command():
    """Runs the command `tempco`; its path is in the environment."""
    path = os.environ.get("TEMPCO_COMMAND")
    if path is None:
        pytest.skip("TEMPCO_COMMAND does not say where the command is")

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [path, *map(str, arguments)], capture_output=True, text=True, check=False
        )

    return run
