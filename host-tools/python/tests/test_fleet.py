"""Many units by an engine: what docs/fleets.md shows."""

from pathlib import Path

import polars as pl
import pytest

import tempco

ROOT = Path(__file__).parents[3]
UNITS = 8


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_an_engine_makes_the_tables_of_a_single_process(scheduler, tmp_path, monkeypatch):
    dask = pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    # What the page shows, as a module: processes import it.
    page = (ROOT / "docs/fleets.md").read_text()
    (tmp_path / "shown.py").write_text(page.split("```python\n")[1].split("```")[0])
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(__import__("sys").modules, "shown", raising=False)
    import shown

    logs = {}
    for number in range(UNITS):
        names = []
        for profile in ("calibration", "verification"):
            log = tempco.simulate("paper", profile, seed=number + 1, rate_hz=0.2, draw=number + 1)
            name = f"{number}-{profile}.csv"
            pl.DataFrame(log.columns()).write_csv(name)
            names.append(name)
        logs[f"RLG-{number}"] = names
    with open("3-verification.csv", "a") as damaged:
        damaged.write("1e9,25,what,0,0\n")

    with dask.config.set(scheduler=scheduler, num_workers=2):
        verdicts = shown.calibrate(logs)
    for serial, paths in logs.items():
        if serial == "RLG-3":
            assert "3-verification.csv:" in verdicts[serial] and "what" in verdicts[serial]
            assert not (tmp_path / "sets" / serial).exists()
            continue
        alone = tempco.fit(paths[::-1], serial, model="composite")
        made = tempco.load(tmp_path / "sets" / serial / "coefficients.json")
        assert made.table_crc32 == alone.table_crc32 and verdicts[serial] == alone.verdict
