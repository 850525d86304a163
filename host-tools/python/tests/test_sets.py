"""Fits, verdicts and files; the same as those of the command."""

import json
import pickle

import numpy as np
import pandas as pd
import polars as pl
import pytest

import tempco


def test_a_set_says_how_it_does(unit, held_out):
    assert unit.verdict in ("accepted", "accepted_with_warnings")
    assert not unit.verified and unit.rejections == []
    evaluation = unit.evaluate(held_out)
    assert evaluation.verified and evaluation.verdict in ("accepted", "accepted_with_warnings")
    for axis in evaluation.axes:
        assert axis["sigma_compensated"] < 0.5 * axis["sigma_raw"]
    assert len(pd.DataFrame(evaluation.axes)) == 3
    for shown in (unit, evaluation):
        assert evaluation.verdict.split("_")[0] in repr(shown)
        assert "improvement" in shown._repr_html_()


def test_reasons_have_code_meaning_and_advice(log):
    columns = log.columns()
    spoilt = {name: np.array(of, dtype=np.float64) for name, of in columns.items()}
    spoilt["x_pulses_per_s"][20_000:30_000] = 0.125
    rejected = tempco.fit(tempco.Log(spoilt), "S1", model="static")
    assert rejected.verdict == "rejected"
    codes = {reason.code: reason for reason in rejected.rejections}
    reason = codes["identical_values"]
    assert "x" in reason.message and reason.meaning and "--exclude" in reason.advice


def test_compensated_columns_are_raw_less_bias(unit, held_out):
    columns = unit.apply(held_out)
    names = [f"{axis}_{what}_{of}" for axis, of, _ in unit.axes for what in ("raw", "bias")]
    assert set(names) < columns.keys()
    for axis, of, _ in unit.axes:
        raw, bias = columns[f"{axis}_raw_{of}"], columns[f"{axis}_bias_{of}"]
        assert raw.dtype == np.float32
        np.testing.assert_array_equal(columns[f"{axis}_compensated_{of}"], raw - bias)
    settling = columns["status"] & tempco.STATUS["settling"]
    assert settling[0] and not settling[-1]
    assert len(pl.DataFrame(columns)) == len(pd.DataFrame(columns)) == len(held_out)


def test_summaries_are_values(log, unit):
    summary = tempco.summarise(log)
    again = pickle.loads(pickle.dumps(summary))
    assert bytes(again) == bytes(summary) and again.sha256 == log.sha256
    assert tempco.fit(again, "S1", model="composite").table_crc32 == unit.table_crc32
    with pytest.raises(tempco.LogError):
        tempco.Summary.from_bytes(bytes(summary)[:-1])
    damaged = bytearray(bytes(summary))
    damaged[1000] ^= 1
    with pytest.raises(tempco.LogError):
        tempco.Summary.from_bytes(bytes(damaged))


def test_the_order_of_logs_does_not_matter(log, held_out):
    tables = {
        tempco.fit(logs, "S1", model="composite").table_crc32
        for logs in ([log, held_out], [held_out, log], [tempco.summarise(held_out), log])
    }
    assert len(tables) == 1


def test_files_are_written_and_read(unit, tmp_path):
    unit.save(tmp_path / "S1")
    names = sorted(path.name for path in (tmp_path / "S1").iterdir())
    assert names == ["coefficients.json", "report.html", "table.bin", "table.h", "table.rs"]
    loaded = tempco.load(tmp_path / "S1" / "coefficients.json")
    assert loaded.to_dict() == unit.to_dict() and loaded.verdict == unit.verdict
    assert (tmp_path / "S1" / "table.bin").read_bytes() == unit.table_bin()
    assert "<svg" in (tmp_path / "S1" / "report.html").read_text()


def test_a_report_of_a_file_has_its_figures(columns, tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame(columns).write_csv(path)
    of_file = tempco.fit(path, "S1", model="static", report=True)
    of_frame = tempco.fit(tempco.Log(columns), "S1", model="static", report=True)
    assert of_file.report.count("<svg") == of_frame.report.count("<svg") > 5


def test_a_figure_has_two_places_for_each_axis(unit, held_out, tmp_path):
    figure = unit.plot(held_out)
    assert len(figure.axes) == 6
    figure.savefig(tmp_path / "figure.png")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"model": "cubic"}, "expected static, composite or auto"),
        ({"model": "static", "overlap": "soft"}, "expected none, hard, mean, linear or smooth"),
        ({"model": "static", "segments": "5:1"}, "segments"),
        ({"tau": 0.0}, "averaging time"),
        ({"exclude": [(5.0, 1.0)]}, "T1 before T2"),
        ({"rate_tau": -1.0}, ""),
        ({"kappa": float("nan")}, ""),
        ({"max_slew": 0.0}, ""),
    ],
)
def test_options_that_cannot_be_are_refused(log, arguments, words):
    with pytest.raises(tempco.FitError) as refused:
        tempco.fit(log, "S1", **arguments)
    assert words in str(refused.value)


def test_logs_that_cannot_be_fitted_are_refused(log):
    with pytest.raises(tempco.FitError):
        tempco.fit([], "S1")
    columns = log.columns()
    short = tempco.Log({name: of[:500] for name, of in columns.items()})
    with pytest.raises(tempco.FitError) as refused:
        tempco.fit(short, "S1")
    assert "degC" in str(refused.value)
    one_axis = {name: of for name, of in columns.items() if name[0] not in "yz"}
    with pytest.raises(tempco.FitError):
        tempco.fit([log, tempco.Log(one_axis)], "S1")
    with pytest.raises(tempco.FitError):
        tempco.fit([tempco.summarise(log), tempco.summarise(log, tau=50.0)], "S1")


def test_sets_and_logs_that_do_not_belong_together_are_refused(unit, log, tmp_path):
    columns = log.columns()
    one_axis = tempco.Log({name: of for name, of in columns.items() if name[0] not in "yz"})
    with pytest.raises(tempco.SetError):
        unit.apply(one_axis)
    with pytest.raises(tempco.EvaluateError):
        unit.evaluate(one_axis)
    with pytest.raises(tempco.EvaluateError):
        unit.evaluate(log, tau=1e8)
    (tmp_path / "coefficients.json").write_text("{}")
    with pytest.raises(tempco.SetError):
        tempco.load(tmp_path / "coefficients.json")
    with pytest.raises(tempco.SetError):
        tempco.load(tmp_path / "none.json")
    for reads in (tempco.read, tempco.summarise, lambda path: tempco.fit(path, "S1")):
        with pytest.raises(tempco.LogError):
            reads(tmp_path / "none.csv")
    with pytest.raises(tempco.TempcoError):
        tempco.simulate("no such unit")


def test_the_command_makes_the_same_set(command, columns, held_out, tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame(columns).write_csv(path)
    for model in ("composite", "auto"):
        folder = tmp_path / model
        ran = command("fit", path, "--serial", "S1", "--out", folder, "--model", model)
        assert ran.returncode in (0, 1), ran.stderr
        by_command = tempco.load(folder / "coefficients.json")
        by_python = tempco.fit(tempco.Log(columns), "S1", model=model)
        assert by_python.table_crc32 == by_command.table_crc32
        assert by_python.table_bin() == (folder / "table.bin").read_bytes()
    other = tmp_path / "held_out.csv"
    pl.DataFrame(held_out.columns()).write_csv(other)
    ran = command("evaluate", tmp_path / "composite" / "coefficients.json", other, "--json")
    expected = json.loads(ran.stdout)
    unit = tempco.load(tmp_path / "composite" / "coefficients.json")
    assert unit.evaluate(tempco.read(other)).to_dict() == expected


def test_the_command_takes_a_summary_of_python(command, columns, unit, tmp_path):
    path = tmp_path / "log.summary"
    path.write_bytes(bytes(tempco.summarise(tempco.Log(columns))))
    ran = command("fit", path, "--serial", "S1", "--out", tmp_path / "S1", "--model", "composite")
    assert ran.returncode in (0, 1), ran.stderr
    by_command = tempco.load(tmp_path / "S1" / "coefficients.json")
    by_python = tempco.fit(tempco.Log(columns), "S1", model="composite")
    assert by_command.table_crc32 == by_python.table_crc32


def test_a_set_becomes_parameters_and_comes_back(tmp_path):
    log = tempco.simulate("mems", "calibration", seed=1, rate_hz=0.5)
    unit = tempco.fit(log, "S1", model="composite")
    assert log.axes[0][1] == "dps"
    for to, name in (("px4", "TC_G0_X3_2"), ("ardupilot", "INS_TCAL1_GYR3_Z")):
        exported = unit.export(to, device_id=7)
        assert name in exported.text
        for loss in exported.losses:
            assert 0 < loss.rms < loss.largest < 0.1 * loss.static_range
            assert loss.rate_and_history > 0
        path = tmp_path / to
        path.write_text(exported.text)
        again = tempco.import_parameters(path, to, unit="dps")
        figures = again.evaluate(log).axes
        assert all(axis["improvement"] > 0.5 for axis in figures)
    with pytest.raises(tempco.SetError):
        unit.export("betaflight")
    with pytest.raises(tempco.SetError):
        unit.export("px4", instance=9, device_id=7)
    with pytest.raises(tempco.SetError, match="device_id="):
        unit.export("px4")
    with pytest.raises(tempco.SetError):
        tempco.import_parameters(tmp_path / "px4", "ardupilot")


def test_no_panic_crosses_the_border(columns):
    """A sweep of odd numbers in every column: a log, or an exception of this package."""
    values = [0.0, -0.0, 1e-308, 5e-324, 1e20, -1e20, 1e300, np.inf, -np.inf, np.nan, 2.0**63]
    for name in columns:
        for value in values:
            for rows in (slice(None), slice(0, 1), slice(100, 200)):
                data = {of: np.array(numbers, dtype=np.float64) for of, numbers in columns.items()}
                data[name][rows] = value
                try:
                    tempco.fit(tempco.Log(data), "S1", model="static")
                except tempco.TempcoError as refused:
                    assert "fault of tempco" not in str(refused), refused
