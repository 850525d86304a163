"""Writes a log as Parquet, as polars does.

usage: to_parquet.py LOG.csv LOG.parquet
"""

import sys

import polars

polars.read_csv(sys.argv[1]).write_parquet(sys.argv[2])
