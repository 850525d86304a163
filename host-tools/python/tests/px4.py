"""A log as PX4 writes it, by its public format."""

import struct
from pathlib import Path

import numpy as np

import tempco


def record(kind: bytes, content: bytes) -> bytes:
    return struct.pack("<Hc", len(content), kind) + content


def write_ulog(path: Path, log: tempco.Log) -> None:
    """Writes the log of a gyro in dps as the first of two sensors; the second turns the other way."""
    columns = log.columns()
    us = (1e6 * columns["time_s"]).astype(np.uint64) + 12_345_678
    rates = np.radians([columns[f"{axis}_dps"] for axis in "xyz"])
    fields = "uint64_t timestamp;uint32_t device_id;float x;float y;float z;float temperature;"
    file = [b"ULog\x01\x12\x35\x01" + bytes(8), record(b"B", bytes(40))]
    file.append(record(b"F", f"sensor_gyro:{fields}".encode()))
    file += [record(b"A", bytes([sensor, sensor, 0]) + b"sensor_gyro") for sensor in (0, 1)]
    for time, temp_c, rate in zip(us, columns["temp_c"], rates.T):
        for sensor, values in enumerate((rate, -rate)):
            row = struct.pack("<HQI4f", sensor, time, 3670282 + sensor, *values, temp_c)
            file.append(record(b"D", row))
    path.write_bytes(b"".join(file))
