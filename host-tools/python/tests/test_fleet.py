"""Many units by an engine: what docs/fleets.md shows."""

import json

import fleet
import pytest

import tempco


@pytest.fixture
def dask(monkeypatch, tmp_path):
    """The code for Dask, in a folder of its own."""
    pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return fleet.shown("Dask", tmp_path)


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_an_engine_makes_the_tables_of_a_single_process(scheduler, dask, tmp_path):
    logs = fleet.two_logs_each(tmp_path, units=8)
    fleet.damage(logs["RLG-3"][1])
    logs["RLG-5"] = [fleet.write(tmp_path / "narrow.csv", "paper", "rest", seed=6)]
    with dask.dask.config.set(scheduler=scheduler, num_workers=2):
        verdicts = dask.calibrate(logs)
    assert "3-verification.csv:" in verdicts["RLG-3"] and "`what`" in verdicts["RLG-3"]
    assert "expected 10 degC or more" in verdicts["RLG-5"]
    for serial, paths in logs.items():
        if serial in ("RLG-3", "RLG-5"):
            assert not (tmp_path / "sets" / serial).exists()
            continue
        alone = tempco.fit(paths[::-1], serial, model="composite")
        made = tempco.load(tmp_path / "sets" / serial / "coefficients.json")
        assert made.table_crc32 == alone.table_crc32 and verdicts[serial] == alone.verdict


def test_a_log_has_one_table_by_command_module_and_engine(dask, command, tmp_path):
    logs = fleet.kinds(tmp_path)
    assert len(logs) == 20
    dask.calibrate(logs)
    tables = set()
    for serial, [path] in logs.items():
        options = ["--model", "composite", "--no-report", "--out", tmp_path / "command" / serial]
        command("fit", path, "--serial", serial, *options)
        table, by_engine = (
            json.loads((tmp_path / by / serial / "coefficients.json").read_text())["table_crc32"]
            for by in ("command", "sets")
        )
        assert table == by_engine == tempco.fit(path, serial, model="composite").table_crc32
        tables.add(table)
    assert len(tables) == 20
