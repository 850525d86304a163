"""What the documents show is run, in order, in a folder of its own."""

import json
from pathlib import Path

import matplotlib
import px4
import pytest

import tempco

matplotlib.use("agg")

ROOT = Path(__file__).parents[3]


def blocks(document: Path) -> list[str]:
    parts = document.read_text().split("```python\n")[1:]
    return [part.split("```")[0] for part in parts]


def cells(notebook: Path) -> list[str]:
    cells = json.loads(notebook.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


SHOWN = {
    "docs/python.md": (blocks, 6),
    "docs/notebook.ipynb": (cells, 6),
    "README.md": (blocks, 1),
}


@pytest.mark.parametrize("name", SHOWN)
def test_what_is_shown_runs(name, tmp_path, monkeypatch):
    read, count = SHOWN[name]
    parts = read(ROOT / name)
    assert len(parts) == count
    monkeypatch.chdir(tmp_path)
    if name == "docs/python.md":
        for file, profile in (("chamber.ulg", "calibration"), ("other.ulg", "verification")):
            px4.write_ulog(tmp_path / file, tempco.simulate("mems", profile, rate_hz=0.5))
    names = {}
    for number, part in enumerate(parts):
        exec(compile(part, f"{name}, part {number + 1}", "exec"), names)
    assert name == "README.md" or (tmp_path / "RLG-7" / "table.bin").is_file()
