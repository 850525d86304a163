"""Logs: from files, from columns in memory, simulated; and their summaries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import LogError, Summary

Path = str | PathLike[str]
"""Name of a file."""


class Log:
    """A log whose every value was checked; its rows are in memory.

    Parameters
    ----------
    data
        A frame of pandas or polars, a table of pyarrow, a structured array, or a dict of arrays. All
        columns have the same length, one row per sample, in order of time. Numbers of any type become
        float64. A column of times (``datetime64``) counts from its first row.
    time
        Name of the column of time, with its unit if that is not s: ``"t_ms:ms"``. Default:
        ``time_s``, or a name with its unit.
    temp
        Name of the temperature, with its unit if that is not degC: ``"T:k"``. A dict gives axes their
        own: ``{"x": "temp_x", "y": "temp_y"}``. Default: ``temp_c``.
    axes
        For each axis the name of its column and its unit: ``{"x": ("x_pulses", "pulses")}``. Units:
        dph, dps, radps, pulses, mps2, g. Default: all columns with names such as ``x_dph``.
    name
        What the log is called in messages and in the set.
    scale_factor
        Angle per pulse in arcsec. It turns pulse counts into deg/h.
    skip_bad_rows
        Leave out and count rows with bad cells. Without, such a log is refused.

    Raises
    ------
    LogError
        With row and column, what was found and what was expected.

    Notes
    -----
    The same numbers give the same table as the command. So read CSV by pandas before version 3 with
    ``float_precision="round_trip"``: its default rounded otherwise.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 7200.0, 0.5)
    >>> temp = 20.0 + 30.0 * t / 7200.0
    >>> log = Log({"t": t, "T": temp, "rate": 0.1 * temp},
    ...           time="t:s", temp="T", axes={"x": ("rate", "dph")})
    >>> len(log), log.interval_s, log.axes
    (14400, 0.5, [('x', 'dph', 'T')])
    """

    def __init__(
        self,
        data: Any,
        *,
        time: str | None = None,
        temp: str | Mapping[str, str] | None = None,
        axes: Mapping[str, tuple[str, str]] | None = None,
        name: str = "columns",
        scale_factor: float | None = None,
        skip_bad_rows: bool = False,
    ) -> None:
        keys = _keys(data)
        temps = _temps(temp)
        axis = [f"{axis}={column}:{unit}" for axis, (column, unit) in (axes or {}).items()]
        if axes is not None and time is not None and temp is not None:
            # Only what is used: other columns may hold anything.
            texts = [time, *temps, *(text.split("=", 1)[1] for text in axis)]
            keys = [key for key in keys if any(_has(text, str(key)) for text in texts)]
        names = [str(key) for key in keys]
        for column in names:
            if names.count(column) > 1:
                raise LogError(f"{names.count(column)} columns are called `{column}`: expected one")
        columns, others = [], []
        for column, key in zip(names, keys):
            numbers = _numbers(column, data[key])
            if numbers is None:
                others.append(column)
            else:
                columns.append((column, numbers))
        reading = _reading(
            time=time,
            temp=temps,
            axis=axis,
            scale_factor=scale_factor,
            skip_bad_rows=skip_bad_rows,
        )
        try:
            self._core = _core.Log.of_columns(name, columns, reading)
        except LogError as error:
            if not others:
                raise
            names = ", ".join(f"`{column}`" for column in others)
            raise LogError(f"{error}; without numbers: {names}") from None

    @classmethod
    def _of(cls, core: _core.Log) -> Log:
        log = cls.__new__(cls)
        log._core = core
        return log

    @property
    def name(self) -> str:
        """Name of the file, or what the columns were called."""
        return self._core.name

    @property
    def sha256(self) -> str:
        """SHA-256 in hexadecimal: of the bytes of the file, or of names and float64 values of all
        columns."""
        return self._core.sha256

    @property
    def interval_s(self) -> float:
        """Median time between rows [s]."""
        return self._core.interval_s

    @property
    def axes(self) -> list[tuple[str, str, str]]:
        """For each axis its name, its unit, and the name of its temperature."""
        return self._core.axes

    @property
    def notes(self) -> list[str]:
        """How it was read, where it is not a plain log; columns not used; bad rows left out."""
        return self._core.notes

    def __len__(self) -> int:
        """Number of rows."""
        return len(self._core)

    def __repr__(self) -> str:
        axes = ", ".join(f"{name} [{unit}]" for name, unit, _ in self.axes)
        return f"Log({self.name!r}, {len(self)} rows of {self.interval_s:g} s: {axes})"

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns, each of shape (rows,): ``time_s`` [s], the temperatures [degC, float32 as the
        core sees them], and the axes in their units, as ``x_dph``. ``pandas.DataFrame`` and
        ``polars.DataFrame`` take them."""
        columns: dict[str, NDArray[Any]] = {"time_s": self._core.time_s()}
        for name, _, temperature in self.axes:
            columns.setdefault(temperature, self._core.temp_c(name))
        for name, unit, _ in self.axes:
            columns[f"{name}_{unit}"] = self._core.raw(name)
        return columns


def read(
    path: Path,
    *,
    time: str | None = None,
    temp: str | Iterable[str] = (),
    axis: Iterable[str] = (),
    where: Iterable[str] = (),
    instance: int | None = None,
    join: Path | None = None,
    scale_factor: float | None = None,
    skip_bad_rows: bool = False,
) -> Log:
    """Reads a log: CSV (plain, gzip or zstd), Parquet, ULog of PX4 or DataFlash of ArduPilot.

    The options are those of the command: ``time="Time [ms]"``, ``axis=["x=GyrX*57.3:dps"]``,
    ``where=["I=0"]``. Names such as ``time_s``, ``temp_c``, ``x_dph`` need none.

    Raises
    ------
    LogError
        With file, line and column, what was found and what was expected.
    """
    reading = _reading(
        time=time,
        temp=[temp] if isinstance(temp, str) else list(temp),
        axis=list(axis),
        filter=list(where),
        instance=instance,
        join=None if join is None else str(join),
        scale_factor=scale_factor,
        skip_bad_rows=skip_bad_rows,
    )
    return Log._of(_core.Log.of_file(path, reading))


def summarise(
    log: Log | Path,
    *,
    rate_tau: float | None = None,
    kappa: float | None = None,
    exclude: Iterable[tuple[float, float]] = (),
    keep_outliers: bool = False,
    max_slew: float | None = None,
    tau: float = 100.0,
    **reading: Any,
) -> Summary:
    """Reduces a log to all that a fit needs of it: some MB, whatever its length.

    A file is read in memory of a fixed size; ``reading`` has the options of :func:`read` for it. A
    summary can be pickled, and ``bytes(summary)`` is the file that ``tempco summarise`` writes. A fit
    of summaries equals the fit of the logs.

    Parameters
    ----------
    rate_tau
        Time constant of the rate estimator [s]. Default: fitted by ``auto``, else 60.
    kappa
        Share of the lag that is compensated. Default: fitted by ``auto``, else 0.
    exclude
        Stretches of time that are left out of the fit, as pairs [s].
    keep_outliers
        Keep spikes and disturbances in the fit.
    max_slew
        Fastest change of temperature that a unit can have [degC/min]. Default: 30.
    tau
        Averaging time of the bias stability [s].
    """
    plan = {
        "rate_tau": rate_tau,
        "kappa": kappa,
        "exclude": [(float(start), float(end)) for start, end in exclude],
        "keep_outliers": keep_outliers,
        "max_slew": max_slew,
        "tau": tau,
    }
    if isinstance(log, Log):
        if reading:
            raise TypeError(f"{', '.join(reading)}: the log was read already")
        return Summary.of_log(log._core, plan)
    return Summary.of_file(log, _reading(**reading), plan)


def simulate(
    unit: str = "paper",
    profile: str = "calibration",
    *,
    seed: int = 1,
    rate_hz: float = 2.0,
    draw: int | None = None,
) -> Log:
    """The log of a simulated unit in a thermal chamber, with the numbers that ``tempco simulate``
    writes.

    Parameters
    ----------
    unit, profile
        Names that ``tempco simulate --list`` shows, or TOML files.
    seed
        Seed of all noise; the same seed gives the same log.
    rate_hz
        Samples per second, 0.01 to 10000.
    draw
        Seed of another unit of this kind. Default: the unit as it is.
    """
    header, _, rows = _core.simulate(unit, profile, seed, rate_hz, draw).partition(b"\n")
    names = header.decode().split(",")
    numbers = np.fromstring(rows.replace(b"\n", b",").decode(), sep=",").reshape(-1, len(names))
    columns = {name: numbers[:, place] for place, name in enumerate(names)}
    return Log(columns, name=f"{unit}-{profile}-{seed}")


def _reading(**given: Any) -> dict[str, Any]:
    reading: dict[str, Any] = {
        "time": None,
        "temp": [],
        "axis": [],
        "filter": [],
        "instance": None,
        "join": None,
        "scale_factor": None,
        "skip_bad_rows": False,
    }
    if "where" in given:
        given["filter"] = list(given.pop("where"))
    unknown = given.keys() - reading.keys()
    if unknown:
        raise TypeError(f"{', '.join(sorted(unknown))}: no option of reading a log")
    if isinstance(given.get("temp"), str):
        given["temp"] = [given["temp"]]
    return {**reading, **given}


def _temps(temp: str | Mapping[str, str] | None) -> list[str]:
    if temp is None:
        return []
    if isinstance(temp, str):
        return [temp]
    return [f"{axis}={column}" for axis, column in temp.items()]


def _has(text: str, name: str) -> bool:
    """Whether the text of an option names a column."""
    of_axis = text.split("=", 1)[-1]
    return any(of == name or of.startswith((f"{name}:", f"{name}*", f"{name}+")) for of in (text, of_axis))


def _keys(data: Any) -> list[Any]:
    """What the columns of a frame are found by: their names, in some frames numbers."""
    if isinstance(data, Mapping):
        return list(data)
    if isinstance(data, np.ndarray) and data.dtype.names:
        return list(data.dtype.names)
    if hasattr(data, "collect"):
        raise LogError(f"{type(data).__name__}: its rows are not in memory yet: collect it first")
    if hasattr(data, "column_names"):
        return list(data.column_names)
    if hasattr(data, "columns"):
        return list(data.columns)
    raise LogError(
        f"{type(data).__name__}: expected a frame, a structured array, or a dict of arrays"
    )


def _numbers(name: str, values: Any) -> NDArray[np.float64] | None:
    """A column as float64; None if it holds no numbers."""
    if hasattr(values, "isna") and hasattr(values, "to_numpy"):
        # pandas: what is missing becomes NaN.
        if values.dtype.kind in "fiub":
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        elif values.dtype.kind == "M":
            # Objects where it has a time zone: the times of UTC.
            values = values.to_numpy(dtype="datetime64[ns]")
        else:
            values = values.to_numpy()
    elif hasattr(values, "to_numpy"):
        values = values.to_numpy()
    if isinstance(values, np.ma.MaskedArray):
        values = values.astype(np.float64).filled(np.nan)
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise LogError(f"column `{name}`: {error}") from None
    if array.ndim != 1:
        raise LogError(f"column `{name}` has the shape {array.shape}: expected (rows,)")
    if array.dtype.kind == "M":
        if len(array) == 0:
            return np.empty(0)
        array = array - array[0]
    if array.dtype.kind == "m":
        array = array / np.timedelta64(1, "s")
    if array.dtype.kind not in "fiub":
        return None
    return np.require(array, np.float64, ["C", "ALIGNED"])
