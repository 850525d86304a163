"""Logs of fleets, and the code of docs/fleets.md: for the tests, and for `cargo xtask verify fleets`."""

import importlib
import sys
from pathlib import Path
from types import ModuleType

import polars as pl

import tempco

ROOT = Path(__file__).parents[3]


def shown(engine: str, folder: Path) -> ModuleType:
    """What the page shows for an engine, as a module in `folder`: processes of the engine import it."""
    section = (ROOT / "docs/fleets.md").read_text().split(f"\n## With {engine}\n")[1]
    name = f"shown_{engine.lower()}"
    (folder / f"{name}.py").write_text(section.split("```python\n")[1].split("```")[0])
    sys.modules.pop(name, None)
    importlib.invalidate_caches()
    return importlib.import_module(name)


def write(path: Path, unit: str, profile: str, seed: int) -> str:
    """Writes the log of a simulated unit as CSV; returns its path."""
    log = tempco.simulate(unit, profile, seed=seed, rate_hz=0.2, draw=seed)
    pl.DataFrame(log.columns()).write_csv(path)
    return str(path)


def two_logs_each(folder: Path, units: int) -> dict[str, list[str]]:
    """For each serial number the names of two logs."""
    profiles = ("calibration", "verification")
    return {
        f"RLG-{number}": [
            write(folder / f"{number}-{profile}.csv", "paper", profile, number + 1)
            for profile in profiles
        ]
        for number in range(units)
    }


def damage(path: str) -> None:
    """Adds a row to a log that no log can have."""
    with open(path, "a") as log:
        log.write("1e9,25,what,0,0\n")


def kinds(folder: Path) -> dict[str, list[str]]:
    """A log of every kind of unit, and one of every profile; for each serial number its name."""
    units = "fibre fog gradient hysteretic ln100 loop mems mode_hops paper smooth wavy"
    profiles = "cold_start cycles mid_ramp_start minor_loops one_rate static swing verification wandering"
    pairs = [(unit, "calibration") for unit in units.split()]
    pairs += [("fog", profile) for profile in profiles.split()]
    return {
        f"{unit}-{profile}": [write(folder / f"{unit}-{profile}.csv", unit, profile, seed + 1)]
        for seed, (unit, profile) in enumerate(pairs)
    }
