"""Coefficient sets: fitted, judged, applied, written."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import SetError, Summary
from ._log import Log, Path, _reading, summarise


@dataclass(frozen=True)
class Message:
    """What rejects a set, or warns of it."""

    code: str
    """Word that stays the same from version to version."""
    axis: str | None
    """Name of the axis, if it is of one."""
    message: str
    """What was found, with axis and numbers."""

    @property
    def meaning(self) -> str:
        """What its code means."""
        return _core.CODES[self.code][0]

    @property
    def advice(self) -> str:
        """What to do about it."""
        return _core.CODES[self.code][1]

    def __str__(self) -> str:
        return f"{self.code}: {self.message}"


@dataclass(frozen=True)
class Loss:
    """What a cubic loses of an axis, in its unit."""

    axis: str
    """Name of the axis."""
    unit: str
    """Its unit."""
    static_range: float
    """Range of the bias at rest over the calibrated temperatures."""
    largest: float
    """Largest difference between the bias at rest and the cubic."""
    rms: float
    """Root mean square of this difference."""
    rate_and_history: float
    """The most that rate and history add to the bias, which is lost as a whole."""


@dataclass(frozen=True)
class Exported:
    """Parameters of an autopilot."""

    text: str
    """The contents of the file."""
    losses: list[Loss]
    """What they lose, axis by axis."""


class _Judged:
    """A verdict with its reasons."""

    _judgement: dict[str, Any]

    @property
    def verdict(self) -> str:
        """``accepted``, ``accepted_with_warnings`` or ``rejected``."""
        return self._judgement["verdict"]

    @property
    def verified(self) -> bool:
        """Whether a log that the set was not fitted to has confirmed it."""
        return self._judgement["verified"]

    @property
    def rejections(self) -> list[Message]:
        """Why it is rejected."""
        return _messages(self._judgement["rejections"])

    @property
    def warnings(self) -> list[Message]:
        """What should be known of it before it is used."""
        return _messages(self._judgement["warnings"])

    def _html(self, title: str, header: list[str], rows: list[list[str]]) -> str:
        reasons = "".join(f"<li>{escape(str(of))}</li>" for of in self.rejections + self.warnings)
        cells = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
        )
        names = "".join(f"<th>{escape(name)}</th>" for name in header)
        return (
            f"<p>{escape(title)}: <b>{self.verdict.replace('_', ' ')}</b></p>"
            f"<ul>{reasons}</ul><table><tr>{names}</tr>{cells}</table>"
        )


class Evaluation(_Judged):
    """How a set does on a log."""

    def __init__(self, figures: dict[str, Any]) -> None:
        self._judgement = self._figures = figures

    @property
    def tau_s(self) -> float:
        """Averaging time of the figures [s]."""
        return self._figures["tau_s"]

    @property
    def axes(self) -> list[dict[str, Any]]:
        """Figures of each axis, in its unit: ``sigma_raw`` and ``sigma_compensated`` are the bias
        stability at ``tau_s``, ``improvement`` is 1 - their ratio, ``allan`` has the Allan deviations.
        A frame of pandas or polars takes the list."""
        return self._figures["axes"]

    def to_dict(self) -> dict[str, Any]:
        """Everything, as ``tempco evaluate --json`` prints it."""
        return self._figures

    def __repr__(self) -> str:
        axes = ", ".join(
            f"{axis['axis']} {axis['sigma_raw']:.3g} -> {axis['sigma_compensated']:.3g}"
            f" {axis['unit']}"
            for axis in self.axes
        )
        return f"Evaluation({self.verdict}: bias stability at {self.tau_s:g} s: {axes})"

    def _repr_html_(self) -> str:
        rows = [
            [
                axis["axis"],
                axis["unit"],
                f"{axis['sigma_raw']:.3g}",
                f"{axis['sigma_compensated']:.3g}",
                f"{100 * axis['improvement']:.1f} %",
            ]
            for axis in self.axes
        ]
        title = f"bias stability at {self.tau_s:g} s on {self._figures['log']['file']}"
        return self._html(title, ["axis", "unit", "before", "after", "improvement"], rows)


class Set(_Judged):
    """A coefficient set, with the verdict on it. :func:`fit` and :func:`load` make one."""

    def __init__(self, core: _core.Set) -> None:
        self._core = core
        self._judgement = json.loads(core.judgement_json())

    @property
    def serial(self) -> str:
        """Serial number of the unit."""
        return self._core.serial

    @property
    def table_crc32(self) -> str:
        """CRC-32 of the table in hexadecimal. The same table has the same, however it was made."""
        return self._core.table_crc32

    @property
    def axes(self) -> list[tuple[str, str, str]]:
        """For each axis its name, its unit, and the name of its temperature."""
        return self._core.axes

    @property
    def report(self) -> str | None:
        """The report of the fit as HTML, if ``fit(..., report=True)`` made it."""
        return self._core.report

    def to_dict(self) -> dict[str, Any]:
        """The whole set: the contents of coefficients.json."""
        return json.loads(self._core.to_json())

    def table_rs(self) -> str:
        """The table as a Rust constant."""
        return self._core.table_rs()

    def table_h(self) -> str:
        """The table as a C header."""
        return self._core.table_h()

    def table_bin(self) -> bytes:
        """The table as a flash image."""
        return self._core.table_bin()

    def save(self, folder: Path) -> None:
        """Writes coefficients.json, table.bin, table.rs, table.h and, if there is one, report.html
        into a folder: all or none."""
        self._core.save(folder)

    def apply(self, log: Log) -> dict[str, NDArray[Any]]:
        """Compensates a log as the firmware does, bit for bit.

        Returns columns of shape (rows,): ``time_s``, the temperatures, for each axis
        ``x_raw_dph``, ``x_bias_dph``, ``x_compensated_dph`` (float32, in its unit), and ``status``
        (uint16, flags by name in ``tempco.STATUS``). A frame of pandas or polars takes them.
        """
        return self._core.apply(log._core)

    def evaluate(self, log: Log, *, against: Set | None = None, tau: float = 100.0) -> Evaluation:
        """Judges the set on a log, before and after compensation.

        ``against`` is a set to compare with, by default the static part of this one; ``tau`` is the
        averaging time [s].
        """
        other = None if against is None else against._core
        return Evaluation(json.loads(self._core.evaluate_json(log._core, other, tau)))

    def export(self, to: str, *, instance: int | None = None, device_id: int | None = None) -> Exported:
        """The set as parameters of an autopilot: ``px4`` or ``ardupilot``. They have one cubic in
        temperature for each axis; what that loses is stated. ``instance`` is the number of the gyro,
        by default the first. PX4 needs its ``device_id``, which ``listener sensor_gyro`` shows: it
        ignores the parameters of any other gyro.

        Raises
        ------
        SetError
            Axes that are no gyro's, a number or range that the autopilot cannot have, no device id.
        """
        if to == "px4" and device_id is None:
            raise SetError(
                "PX4 ignores parameters without the device id of their gyro: expected device_id=, which "
                "`listener sensor_gyro` shows"
            )
        text, losses = self._core.export(to, instance, device_id or 0)
        return Exported(
            text,
            [Loss(*axis, span, *cubic, rest) for axis, span, cubic, rest in losses],
        )

    def plot(self, log: Log, *, tau: float = 100.0) -> Any:
        """A figure of matplotlib: means over ``tau`` seconds of each axis before and after, against
        time and against temperature."""
        from matplotlib.figure import Figure

        columns = self.apply(log)
        stretch = np.floor((columns["time_s"] - columns["time_s"][0]) / tau).astype(np.int64)
        _, first = np.unique(stretch, return_index=True)
        rows = np.diff(np.append(first, len(stretch)))

        def means(name: str) -> NDArray[np.float64]:
            return np.add.reduceat(columns[name].astype(np.float64), first) / rows

        hours = means("time_s") / 3600.0
        figure = Figure(figsize=(10.0, 2.6 * len(self.axes)), layout="constrained")
        places = figure.subplots(len(self.axes), 2, squeeze=False)
        for (axis, unit, temperature), (by_time, by_temp) in zip(self.axes, places):
            for what in ["raw", "compensated"]:
                values = means(f"{axis}_{what}_{unit}")
                by_time.plot(hours, values, label=what)
                by_temp.plot(means(temperature), values, ".", label=what)
            by_time.set(ylabel=f"{axis} [{unit}]", xlabel="time [h]")
            by_temp.set(xlabel=f"{temperature} [degC]")
            by_time.legend()
        return figure

    def __repr__(self) -> str:
        return f"Set({self.serial!r}, table {self.table_crc32}: {self.verdict})"

    def _repr_html_(self) -> str:
        rows = []
        for channel in self.to_dict()["channels"]:
            for axis in channel["axes"]:
                of = axis.get("statistics")
                cells = ["-", "-", "-"]
                if of is not None and of["n"] > 1:
                    before, after = of["sigma_raw"], of["sigma_compensated"]
                    cells = [f"{before:.3g}", f"{after:.3g}", f"{100 * (1 - after / before):.1f} %"]
                rows.append([axis["name"], axis["unit"], *cells])
        title = f"unit {self.serial}, table {self.table_crc32}"
        return self._html(title, ["axis", "unit", "before", "after", "improvement"], rows)


def fit(
    logs: Log | Path | Summary | Iterable[Log | Path | Summary],
    serial: str,
    *,
    model: str = "auto",
    overlap: str = "linear",
    segments: str | None = None,
    report: bool = False,
    **plan: Any,
) -> Set:
    """Fits a coefficient set to the chamber logs of a unit, and judges it.

    Parameters
    ----------
    logs
        One or more logs, names of files, or summaries, in any order.
    serial
        Serial number of the unit.
    model
        ``auto``, or the models of the paper: ``static``, ``composite``.
    overlap
        How segments are joined: none, hard, mean, linear, smooth.
    segments
        Segments in degC, as ``"-15:15,5:35"``. Default: the measured range is divided.
    report
        Make the report, too. It needs the rows of the logs.
    plan
        Options of :func:`summarise`, for logs that are not summaries yet.

    Raises
    ------
    FitError
        Logs that do not belong together, too little range of temperature, no usable row.
    LogError
        A file that cannot be read.
    """
    if isinstance(logs, (Log, Summary, str)) or hasattr(logs, "__fspath__"):
        logs = [logs]
    summaries, rows = [], []
    for log in logs:
        if isinstance(log, Summary):
            summaries.append(log)
            rows.append(None)
        else:
            summaries.append(summarise(log, **plan))
            rows.append(log._core if isinstance(log, Log) else log)
    core = _core.fit(
        summaries,
        rows,
        _reading(),
        serial,
        model,
        overlap,
        segments,
        report,
    )
    return Set(core)


def import_parameters(
    path: Path,
    autopilot: str,
    *,
    instance: int | None = None,
    unit: str = "radps",
    serial: str = "imported",
) -> Set:
    """Makes a set of a file with parameters of ``px4`` or ``ardupilot``: cubics become quadratic cells.
    ``unit`` is the one of the axes in your logs: dph, dps or radps.

    Raises
    ------
    SetError
        A file that lacks a parameter, or has a range that cannot be.
    """
    return Set(_core.import_parameters(path, autopilot, instance, unit, serial))


def load(path: Path) -> Set:
    """Reads a set from coefficients.json.

    Raises
    ------
    SetError
        A file that is no set, or one that was damaged.
    """
    return Set(_core.load(path))


def _messages(of: list[dict[str, Any]]) -> list[Message]:
    return [Message(each["code"], each.get("axis"), each["message"]) for each in of]
