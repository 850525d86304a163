"""Logs from frames of every kind, and what is refused."""

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import tempco

AXES = {name: (f"{name}_pulses", "pulses") for name in "xyz"}


def structured(columns):
    array = np.zeros(len(columns["time_s"]), dtype=[(name, "f8") for name in columns])
    for name, values in columns.items():
        array[name] = values
    return array


def unaligned(columns):
    bytes_of = {name: b"-" + of.astype(np.float64).tobytes() for name, of in columns.items()}
    return {name: np.frombuffer(of, np.uint8)[1:].view(np.float64) for name, of in bytes_of.items()}


FRAMES = {
    "dict": dict,
    "structured": structured,
    "pandas": pd.DataFrame,
    "polars": pl.DataFrame,
    "pyarrow": pa.table,
    "nullable": lambda columns: pd.DataFrame(columns).convert_dtypes(),
    "strided": lambda columns: {name: np.repeat(of, 2)[::2] for name, of in columns.items()},
    "reversed twice": lambda columns: {name: of[::-1].copy()[::-1] for name, of in columns.items()},
    "columns of a matrix": lambda columns: dict(zip(columns, np.stack([*columns.values()], 1).T)),
    "unaligned": unaligned,
    "lists": lambda columns: {name: of.tolist() for name, of in columns.items()},
    "long doubles": lambda columns: {name: of.astype(np.longdouble) for name, of in columns.items()},
    "arrow in pandas": lambda columns: pa.table(columns).to_pandas(types_mapper=pd.ArrowDtype),
    "chunked": lambda columns: pa.concat_tables([pa.table(columns)[:9], pa.table(columns)[9:]]),
    "integers": lambda columns: {
        name: of.astype(np.int32) if "pulses" in name else of for name, of in columns.items()
    },
    "big-endian": lambda columns: {name: of.astype(">f8") for name, of in columns.items()},
    "masked": lambda columns: {name: np.ma.array(of) for name, of in columns.items()},
}


@pytest.mark.parametrize("kind", FRAMES)
def test_frames_of_every_kind_give_the_same_log(kind, columns):
    expected = tempco.Log(columns)
    found = tempco.Log(FRAMES[kind](columns))
    assert found.sha256 == expected.sha256
    assert found.axes == [(name, "pulses_per_s", "temp_c") for name in "xyz"]
    for name, values in expected.columns().items():
        np.testing.assert_array_equal(found.columns()[name], values)


def test_arrays_that_cannot_be_written_are_read(columns):
    for values in columns.values():
        values.flags.writeable = False
    assert len(tempco.Log(columns)) == len(columns["time_s"])


def test_single_precision_is_taken_as_it_is(columns):
    single = {name: of.astype(np.float32) for name, of in columns.items()}
    double = {name: of.astype(np.float64) for name, of in single.items()}
    assert tempco.Log(single).sha256 == tempco.Log(double).sha256


def test_columns_can_have_numbers_for_names(columns):
    frame = pd.DataFrame(dict(enumerate(columns.values())))
    found = tempco.Log(frame, time="0:s", temp="1", axes={"x": ("2", "pulses")})
    expected = tempco.Log(columns).columns()["x_pulses_per_s"]
    np.testing.assert_array_equal(found.columns()["x_pulses_per_s"], expected)


@pytest.mark.parametrize("zone", [None, "UTC", "Asia/Tokyo"])
def test_times_may_have_a_zone(zone, columns):
    start = pd.Timestamp("2026-11-29T09:00:00", tz=zone)
    frame = pd.DataFrame(columns).assign(time_s=start + pd.to_timedelta(columns["time_s"], unit="s"))
    expected = tempco.Log(columns).columns()["time_s"]
    np.testing.assert_allclose(tempco.Log(frame).columns()["time_s"], expected - expected[0])


def test_columns_can_have_any_name_and_unit(columns):
    start = np.datetime64("2026-11-29T09:00:00")
    other = {
        "stamp": start + (1e9 * columns["time_s"]).astype("timedelta64[ns]"),
        "T:sensor": columns["temp_c"].astype(np.float64) + 273.15,
        "note": ["a"] * len(columns["time_s"]),
        **{f"gyro {name}": columns[f"{name}_pulses"] for name in "xyz"},
    }
    axes = {name: (f"gyro {name}", "pulses") for name in "xyz"}
    found = tempco.Log(other, time="stamp:s", temp="T:sensor:k", axes=axes)
    expected = tempco.Log(columns)
    np.testing.assert_allclose(found.columns()["time_s"], expected.columns()["time_s"])
    np.testing.assert_allclose(found.columns()["T:sensor"], expected.columns()["temp_c"], atol=1e-4)


def test_a_scale_factor_makes_angles_of_pulses(columns):
    log = tempco.Log(columns, scale_factor=0.5)
    assert log.axes[0][1] == "dph"
    expected = 0.5 * columns["x_pulses"] / log.interval_s
    np.testing.assert_allclose(log.columns()["x_dph"], expected)


def test_a_frame_of_the_numbers_of_a_file_is_the_log_of_the_file(columns, tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame(columns).write_csv(path)
    of_file = tempco.read(path)
    of_frame = tempco.Log(pd.read_csv(path))
    fits = [tempco.fit(log, "S1", model="static") for log in (of_file, path, of_frame)]
    assert len({of.table_crc32 for of in fits}) == 1


def assert_same(path, expected):
    for name, values in tempco.read(path).columns().items():
        np.testing.assert_array_equal(values, expected[name], err_msg=str(path))


@pytest.mark.parametrize("level", [-5, 1, 3, 9, 19])
def test_text_packed_by_zstd_is_read(level, columns, tmp_path):
    text = pl.DataFrame(columns).write_csv().encode()
    plain, packed = tmp_path / "log.csv", tmp_path / "log.csv.zst"
    plain.write_bytes(text)
    codec = pa.Codec("zstd", compression_level=level)
    # Two frames, one behind the other.
    parts = [text[:70_000], text[70_000:]]
    packed.write_bytes(b"".join(codec.compress(part, asbytes=True) for part in parts))
    assert_same(packed, tempco.read(plain).columns())


@pytest.mark.parametrize("version", ["1.0", "2.0"])
@pytest.mark.parametrize("dictionary", [False, True])
@pytest.mark.parametrize("packing", ["none", "snappy", "gzip", "zstd", "lz4"])
def test_parquet_packed_in_any_way_is_read(packing, dictionary, version, columns, tmp_path):
    plain, path = tmp_path / "log.csv", tmp_path / "log.parquet"
    pl.DataFrame(columns).write_csv(plain)
    pq.write_table(
        pa.table(columns),
        path,
        compression=packing,
        use_dictionary=dictionary,
        data_page_version=version,
        data_page_size=5000,
        row_group_size=3000,
    )
    assert_same(path, tempco.read(plain).columns())


def bad(columns, **changed):
    return {**columns, **changed}


def with_value(values, row, value):
    values = values.astype(np.float64)
    values[row] = value
    return values


REFUSED = {
    "nothing": (lambda c: {}, "no time column"),
    "no frame": (lambda c: 7, "expected a frame"),
    "no axis": (lambda c: {"time_s": c["time_s"], "temp_c": c["temp_c"]}, "no axis column"),
    "lengths": (lambda c: bad(c, temp_c=c["temp_c"][:-1]), "column `temp_c` has"),
    "shape": (lambda c: bad(c, temp_c=np.zeros((2, 2))), "has the shape (2, 2)"),
    "scalar": (lambda c: bad(c, temp_c=1.0), "has the shape ()"),
    "matrix": (lambda c: bad(c, temp_c=c["temp_c"].reshape(-1, 1)), "expected (rows,)"),
    "no rows in common": (lambda c: bad(c, temp_c=[[1], [1, 2]]), "column `temp_c`: "),
    "no column": (lambda c: bad(c, temp_c=None), "has the shape ()"),
    "same name twice": (
        lambda c: pd.concat([pd.DataFrame(c), pd.DataFrame({"temp_c": c["temp_c"]})], axis=1),
        "2 columns are called `temp_c`",
    ),
    "not in memory": (lambda c: pl.DataFrame(c).lazy(), "collect it first"),
    "nothing in a frame": (lambda c: pd.DataFrame(), "no time column"),
    "all NaN": (lambda c: bad(c, temp_c=np.full(len(c["temp_c"]), np.nan)), "column 2 `temp_c`"),
    "masked": (lambda c: bad(c, x_pulses=np.ma.array(c["x_pulses"], mask=c["time_s"] == 8)), "`NaN`"),
    "null": (lambda c: pl.DataFrame(c).with_columns(x_pulses=pl.lit(None, pl.Float64)), "row 1, "),
    "no time": (
        lambda c: bad(c, time_s=np.full(len(c["time_s"]), np.datetime64("NaT", "ns"))),
        "row 1, column 1 `time_s`",
    ),
    "empty": (lambda c: {name: of[:0] for name, of in c.items()}, "expected at least 2"),
    "one row": (lambda c: {name: of[:1] for name, of in c.items()}, "expected at least 2"),
    "text": (lambda c: bad(c, temp_c=["a"] * len(c["temp_c"])), "without numbers: `temp_c`"),
    "objects": (lambda c: bad(c, temp_c=[None] * len(c["temp_c"])), "without numbers: `temp_c`"),
    "complex": (lambda c: bad(c, temp_c=c["temp_c"] * 1j), "without numbers: `temp_c`"),
    "NaN": (
        lambda c: bad(c, x_pulses=with_value(c["x_pulses"], 4, np.nan)),
        "row 5, column 3 `x_pulses`: `NaN`: expected a finite number",
    ),
    "infinite": (lambda c: bad(c, x_pulses=with_value(c["x_pulses"], 4, np.inf)), "row 5"),
    "too large": (lambda c: bad(c, x_pulses=with_value(c["x_pulses"], 4, 1e30)), "1e20 at most"),
    "kelvin": (lambda c: bad(c, temp_c=c["temp_c"] + 273.15), "is it in kelvin?"),
    "back in time": (
        lambda c: bad(c, time_s=with_value(c["time_s"], 4, 0.5)),
        "expected time to increase",
    ),
    "still": (lambda c: bad(c, time_s=0.0 * c["time_s"]), "expected"),
    "NaN time": (lambda c: bad(c, time_s=with_value(c["time_s"], 0, np.nan)), "row 1"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_no_log_is_refused_with_its_place(kind, columns):
    change, words = REFUSED[kind]
    with pytest.raises(tempco.LogError) as refused:
        tempco.Log(change(columns), name="mine")
    assert words in str(refused.value), refused.value


def test_bad_rows_can_be_left_out(columns):
    data = bad(columns, x_pulses=with_value(columns["x_pulses"], 4, np.nan))
    log = tempco.Log(data, skip_bad_rows=True)
    assert len(log) == len(columns["time_s"]) - 1
    assert any("1 bad rows left out" in note for note in log.notes)


def test_blank_temperatures_are_held(columns):
    temp_c = with_value(columns["temp_c"], 4, np.nan)
    log = tempco.Log(bad(columns, temp_c=temp_c))
    assert log.columns()["temp_c"][4] == log.columns()["temp_c"][3]
