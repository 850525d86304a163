"""The job of `tempco fit --model composite`, as one would write it with numpy.

usage: fit.py pandas|polars|duckdb LOG.csv

Reads the log, runs a causal first-order filter of 60 s over the temperature, takes the rate from it,
and solves 4 segments of 5 terms for 3 axes by numpy.linalg.lstsq.

duckdb sums up the normal equations in SQL, in one pass that keeps no row. SQL has no recursive filter,
so its rate is the change over 60 s. Its z is of the whole range.
"""

import sys

import numpy as np

SEGMENTS = [(-15.0, 15.0), (5.0, 35.0), (25.0, 60.0), (50.0, 80.0)]
AXES = ["x_dph", "y_dph", "z_dph"]
TAU_S = 60.0


def read_pandas(path):
    import pandas

    log = pandas.read_csv(path)
    return log["time_s"].to_numpy(), log["temp_c"].to_numpy(), log[AXES].to_numpy()


def read_polars(path):
    import polars

    log = polars.read_csv(path)
    return log["time_s"].to_numpy(), log["temp_c"].to_numpy(), log.select(AXES).to_numpy()


def filtered(temp_c, alpha):
    """y[i] = y[i - 1] + alpha (x[i] - y[i - 1]), block by block: numpy has no recursive filter."""
    decay = 1.0 - alpha
    # Within a block, powers of the decay must not vanish.
    block = max(2, min(len(temp_c), int(-200.0 / np.log(decay))))
    powers = decay ** np.arange(1, block + 1)
    out = np.empty_like(temp_c)
    state = temp_c[0]
    for start in range(0, len(temp_c), block):
        x = temp_c[start : start + block]
        p = powers[: len(x)]
        out[start : start + len(x)] = p * (state + np.cumsum(alpha * x / p))
        state = out[start + len(x) - 1]
    return out


def print_segment(low, high, coefficients):
    print(low, high, coefficients.T.tolist())


def fit_rows(read, path):
    time_s, temp_c, raw = read(path)
    interval_s = np.median(np.diff(time_s))
    lagging = filtered(temp_c, 1.0 - np.exp(-interval_s / TAU_S))
    rate = (temp_c - lagging) / TAU_S * 60.0
    for low, high in SEGMENTS:
        rows = (temp_c >= low) & (temp_c <= high)
        z = (temp_c[rows] - 0.5 * (low + high)) / (0.5 * (high - low))
        r = rate[rows]
        terms = np.column_stack([np.ones_like(z), z, z * z, r, r * z])
        coefficients, *_ = np.linalg.lstsq(terms, raw[rows], rcond=None)
        print_segment(low, high, coefficients)


def fit_duckdb(path):
    import duckdb

    log = f"read_csv('{path}')"
    first, second = duckdb.sql(f"select time_s from {log} limit 2").fetchnumpy()["time_s"]
    rows = round(TAU_S / (second - first))
    rate = f"(temp_c - lag(temp_c, {rows}, temp_c) over ()) / {TAU_S / 60.0}::double"
    # All edges of segments are multiples of 5 degC: the sums of such bins add up to those of segments.
    terms = ["1::double", "z", "z * z", "r", "r * z"]
    sums = ", ".join(f"sum({a} * {b})" for a in terms for b in terms + AXES)
    binned = duckdb.sql(
        f"select 5 * floor(temp_c / 5) as bin, {sums} from (select *, (temp_c - 30) / 50 as z from "
        f"(select *, {rate} as r from {log})) group by bin"
    ).fetchall()
    for low, high in SEGMENTS:
        within = [row[1:] for row in binned if low <= row[0] < high]
        normal = np.array(within, dtype=float).sum(axis=0).reshape(5, 5 + len(AXES))
        print_segment(low, high, np.linalg.solve(normal[:, :5], normal[:, 5:]))


def main():
    peer, path = sys.argv[1:]
    if peer == "duckdb":
        fit_duckdb(path)
    else:
        fit_rows({"pandas": read_pandas, "polars": read_polars}[peer], path)


main()
