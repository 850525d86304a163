"""Temperature compensation of gyroscopes.

A gyro at rest should read zero. What it reads instead, its bias, moves with temperature and with how
fast the temperature changes. This package fits a model of that bias to logs of a thermal chamber,
judges it, applies it as the firmware does, and writes the table for the firmware.

>>> import tempco
>>> log = tempco.simulate("paper", "calibration", seed=1)
>>> unit = tempco.fit(log, serial="RLG-7", model="composite")
>>> unit.verdict
'accepted'
>>> held_out = tempco.simulate("paper", "verification", seed=2)
>>> evaluation = unit.evaluate(held_out)
>>> evaluation.axes[0]["improvement"] > 0.5
True

The work is done by the same library as that of the command ``tempco``, with the core that flies: the
same numbers give the same table.
"""

from ._core import (
    STATUS,
    EvaluateError,
    FitError,
    LogError,
    SetError,
    Summary,
    TempcoError,
)
from ._log import Log, read, simulate, summarise
from ._set import Evaluation, Exported, Loss, Message, Set, fit, import_parameters, load

__all__ = [
    "STATUS",
    "EvaluateError",
    "Evaluation",
    "Exported",
    "FitError",
    "Log",
    "LogError",
    "Loss",
    "Message",
    "Set",
    "SetError",
    "Summary",
    "TempcoError",
    "fit",
    "import_parameters",
    "load",
    "read",
    "simulate",
    "summarise",
]
