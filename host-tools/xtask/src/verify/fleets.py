"""Runs the code of docs/fleets.md on Spark, with damage and a worker that dies.

Usage: fleets.py TEMPCO FOLDER
"""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import fleet
import tempco
from pyspark.sql import SparkSession, functions

command, folder = sys.argv[1], Path(sys.argv[2])
UNITS = 100
DAMAGED_LOG, DAMAGED_SUMMARY, NARROW_LOG, DEADLY_LOG = "RLG-37", "RLG-61", "RLG-12", "RLG-83"

shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
sys.path.insert(0, str(folder))
shown = fleet.shown("Spark", folder)
os.environ["PYTHONPATH"] += os.pathsep + str(folder)
spark = (
    SparkSession.builder.master("local[2,4]")
    .config("spark.ui.enabled", "false")
    .config("spark.ui.showConsoleProgress", "false")
    .getOrCreate()
)
spark.sparkContext.setLogLevel("OFF")


def must(holds, what):
    if not holds:
        sys.exit(f"not so: {what}")
    print(what, flush=True)


def alone(serial, paths):
    """The table of a single process."""
    return tempco.fit(paths[::-1], serial, model="composite").table_crc32


# The same table by all ways, whatever the unit and the profile.
logs = fleet.kinds(folder)
units = shown.calibrate(spark, logs, folder / "kinds")
equal = 0
for serial, [path] in logs.items():
    out = folder / "command" / serial
    options = ["--serial", serial, "--model", "composite", "--no-report", "--out", out]
    # It says by its code whether the set is accepted; some of these are not.
    subprocess.run([command, "fit", path, *options], capture_output=True, check=False)
    by_command = json.loads((out / "coefficients.json").read_text())["table_crc32"]
    equal += units[serial].table_crc32 == by_command == alone(serial, [path])
must(equal == len(logs) == 20, f"{equal} of 20 kinds of logs have one table")

# A fleet with damage.
logs = fleet.two_logs_each(folder, UNITS)
fleet.damage(logs[DAMAGED_LOG][1])
logs[NARROW_LOG] = [fleet.write(folder / "narrow.csv", "paper", "rest", seed=1)]
deadly, death = logs[DEADLY_LOG][0], folder / "death"
summaries_of = shown.summaries_of


def dying(batches):
    """Summarises. The first worker that has the deadly log dies after it, in the midst of its task."""
    for batch in summarised(batches):
        yield batch
        if batch.column("path")[0].as_py() == deadly and not death.exists():
            death.write_text(str(os.getpid()))
            os.kill(os.getpid(), signal.SIGKILL)


def damaged(frame):
    """Summaries that were kept in Parquet; two bytes of one are noise."""
    kept = str(folder / "summaries")
    summaries_of(frame).write.parquet(kept)
    summary, path = functions.col("summary"), functions.col("path")
    noise = functions.overlay(summary, functions.lit(b"\xa5\x5a"), 1000)
    is_hit = path == logs[DAMAGED_SUMMARY][0]
    damaged = functions.when(is_hit, noise).otherwise(summary)
    return spark.read.parquet(kept).withColumn("summary", damaged)


summarised, shown.summarised = shown.summarised, dying
shown.summaries_of = damaged
units = shown.calibrate(spark, logs, folder / "sets")
must(death.exists(), f"the worker {death.read_text()} was killed, its task was done again")
must(sorted(units) == sorted(logs), f"{len(units)} of {UNITS} units have a row")
reasons = {DAMAGED_LOG: "`what`", DAMAGED_SUMMARY: "its checksum", NARROW_LOG: "10 degC or more"}
for serial, word in reasons.items():
    refused = units[serial].refused or ""
    must(units[serial].verdict is None and word in refused, f"{serial} is refused: {refused}")
    must(not (folder / "sets" / serial).exists(), f"{serial} has no set")
refused = [serial for serial, unit in units.items() if unit.refused]
must(sorted(refused) == sorted(reasons), "no other unit is refused")
equal = 0
for serial in sorted(logs.keys() - set(refused)):
    written = tempco.load(Path(units[serial].folder) / "coefficients.json")
    image = (Path(units[serial].folder) / "table.bin").read_bytes()
    table = alone(serial, logs[serial])
    if not table == units[serial].table_crc32 == written.table_crc32 or image != written.table_bin():
        sys.exit(f"not so: {serial} has the table {table} of a single process")
    equal += 1
print(f"{equal} of {UNITS - len(reasons)} tables are those of a single process")
spark.stop()
