#!/usr/bin/env python3
"""Writes reference.csv: overlapping Allan deviations by allantools.

    python3 -m venv venv
    venv/bin/pip install allantools==2024.6
    venv/bin/python reference.py > reference.csv

The series are made from whole numbers and single roundings, so that allantools.rs makes the same
ones, bit by bit.
"""

import allantools
import numpy

MASK = (1 << 64) - 1


def splitmix64(seed):
    """Whole numbers of 64 bits (Steele, Lea and Flood, 2014)."""
    state = seed
    while True:
        state = (state + 0x9E3779B97F4A7C15) & MASK
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        yield z ^ (z >> 31)


def uniform(seed):
    """White noise, uniform over -0.5 to 0.5."""
    return ((bits >> 11) * 2.0**-53 - 0.5 for bits in splitmix64(seed))


def white(count):
    return [value for value, _ in zip(uniform(1), range(count))]


def random_walk(count):
    values, value = [], 3.0
    for step, _ in zip(uniform(2), range(count)):
        value += step
        values.append(value)
    return values


def pulses(count):
    """Whole counts of an angle that turns by 0.3 and noise of 0.5 to 1 count per row."""
    values, angle, before = [], 0, 0
    for bits, _ in zip(splitmix64(3), range(count)):
        angle += 1288490189 + (bits >> 32) - (1 << 31)
        values.append(float((angle >> 32) - before))
        before = angle >> 32
    return values


def beside_a_constant(count):
    return [10000.0 + value for value in white(count)]


SERIES = [
    ("white", 1.0, white(20_000)),
    ("random_walk", 0.1, random_walk(30_011)),
    ("pulses", 0.5, pulses(65_537)),
    ("beside_a_constant", 2.0, beside_a_constant(12_345)),
]

print("series,interval_s,tau_s,n,deviation")
for name, interval_s, values in SERIES:
    octaves = [2.0**k * interval_s for k in range(20) if 2 ** (k + 1) <= len(values)]
    taus, deviations, _, counts = allantools.oadev(
        numpy.array(values), rate=1.0 / interval_s, data_type="freq", taus=octaves
    )
    for tau_s, deviation, n in zip(taus, deviations, counts):
        print(f"{name},{interval_s!r},{float(tau_s)!r},{int(n)},{float(deviation)!r}")
