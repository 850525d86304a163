"""Compares how tempco reads logs of autopilots with how pyulog and pymavlink do.

Usage: logs.py TEMPCO SAMPLE.ulg FOLDER
"""

import csv
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
from pymavlink.DFReader import DFReader_binary
from pyulog import ULog

tempco, sample, folder = sys.argv[1], sys.argv[2], Path(sys.argv[3])


def run(*words):
    subprocess.run([tempco, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def compare(what, set_file, log, columns):
    """Columns are time [us], temperature and three axes."""
    out = folder / "out.csv"
    run("apply", set_file, log, "--out", out)
    rows = list(csv.reader(out.open()))[1:]
    read = np.array([[float(row[c]) for c in (0, 1, 2, 5, 8)] for row in rows])
    wanted = np.array(columns, dtype=float).T
    wanted[:, 0] /= 1e6
    is_equal = read.shape == wanted.shape and (read[:, 0] == wanted[:, 0]).all()
    if not is_equal or not (read[:, 1:].astype("f4") == wanted[:, 1:].astype("f4")).all():
        sys.exit(f"{what}: tempco reads other values")
    print(f"{what}: {read.size} values are equal")


# A cycle of the chamber for three sensors, in a file that pyulog writes.
rng = np.random.default_rng(1)
time_s = np.arange(9000) * 0.5
temp_c = 20 - 30 * np.cos(time_s / 4500 * 2 * np.pi)
sensors = []
for sensor in range(3):
    slopes = np.radians([0.01, -0.02, 0.03]) * (1 + sensor)
    axes = np.outer(slopes, temp_c) + 0.002 * (rng.random((3, 9000)) - 0.5)
    us = (12345678 + sensor + time_s * 1e6).astype("u8")
    sensors.append([us, (temp_c + sensor).astype("f4"), *axes.astype("f4")])

log = ULog(sample)
for data in log.data_list:
    if data.name == "sensor_gyro":
        us, temps, x, y, z = sensors[data.multi_id]
        kinds = {name: column.dtype for name, column in data.data.items()}
        columns = {name: np.zeros(9000, kind) for name, kind in kinds.items()}
        columns |= {"timestamp": us, "temperature": temps, "x": x, "y": y, "z": z}
        data.data = columns
written = folder / "written.ulg"
log.write_ulog(str(written))
run("fit", written, "--serial", "V", "--model", "composite", "--out", folder / "ulg", "--no-report")
for sensor in range(3):
    set_file = folder / f"ulg/imu{sensor}/coefficients.json"
    for name, file in [("pyulog's", written), ("a real", sample)]:
        data = ULog(str(file)).get_dataset("sensor_gyro", sensor).data
        names = ["timestamp", "temperature", "x", "y", "z"]
        compare(f"{name} .ulg, instance {sensor}", set_file, file, [data[n] for n in names])

# The same as a file of ArduPilot, that pymavlink reads.


def fmt(kind, size, name, types, labels):
    texts = zip((name, types, labels), (4, 16, 64))
    return struct.pack("<3B2B", 0xA3, 0x95, 0x80, kind, size) + b"".join(
        text.encode().ljust(length, b"\0") for text, length in texts
    )


labels = "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"
messages = [
    fmt(0x80, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
    fmt(2, 31, "PARM", "QNf", "TimeUS,Name,Value"),
    fmt(3, 54, "IMU", "QBffffffIIfBBHH", labels),
    struct.pack("<3BQ16sf", 0xA3, 0x95, 2, 1, b"INS_TCAL1_ENABLE", 0),
]
for row in range(9000):
    for sensor, (us, temps, x, y, z) in enumerate(sensors):
        values = us[row], sensor, x[row], y[row], z[row], 0, 0, -9.8, 0, 0, temps[row], 1, 1, 1, 1
        messages.append(struct.pack("<3BQB6f2If2B2H", 0xA3, 0x95, 3, *values))
written = folder / "written.bin"
written.write_bytes(b"".join(messages))
run("fit", written, "--serial", "V", "--model", "composite", "--out", folder / "bin", "--no-report")
columns = {0: [], 1: [], 2: []}
reader = DFReader_binary(str(written))
while (message := reader.recv_match(type="IMU")) is not None:
    columns[message.I].append([message.TimeUS, message.T, message.GyrX, message.GyrY, message.GyrZ])
for sensor, rows in columns.items():
    set_file = folder / f"bin/imu{sensor}/coefficients.json"
    compare(f"a .bin, instance {sensor}", set_file, written, np.array(rows).T)
