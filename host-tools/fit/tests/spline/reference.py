"""Writes reference.csv: least squares of the spline model by scipy's B-splines and numpy.

The rows are made by the formulas of `least_squares::reference` in the library, which reads the file.
Run with numpy 2.4.6 and scipy 1.17.1.
"""

import pathlib

import numpy as np
from scipy.interpolate import BSpline

BREAKPOINTS = np.array([-15.0, 2.0, 20.0, 31.5, 55.0, 80.0])

i = np.arange(2000)
temp = 32.5 + 47.5 * np.sin(0.0173 * i)
rate = 1.3 * np.cos(0.0173 * i) + 0.4 * np.sin(0.31 * i)
log = i * 2 // 2000
y = (
    0.01 * np.cos(0.05 * temp)
    + 2e-4 * temp
    + rate * (0.003 + 4e-5 * temp)
    + np.where(log == 0, 0.002, -0.001)
    + 0.005 * np.sin(12.9898 * i)
)

knots = np.concatenate([BREAKPOINTS[[0, 0]], BREAKPOINTS, BREAKPOINTS[[-1, -1]]])
splines = BSpline.design_matrix(temp, knots, 2).toarray()
contrast = np.where(log == 0, 1.0, -1.0)[:, None]
hats = np.stack(
    [np.interp(temp, BREAKPOINTS, row) * rate for row in np.eye(len(BREAKPOINTS))], axis=1
)
design = np.concatenate([splines, contrast, hats], axis=1)
coefficients, squares, rank, _ = np.linalg.lstsq(design, y, rcond=None)
assert rank == design.shape[1]
covariance = np.linalg.inv(design.T @ design) * squares[0] / (len(y) - rank)

with open(pathlib.Path(__file__).with_name("reference.csv"), "w") as out:
    out.write("coefficient,sigma\n")
    for value, sigma in zip(coefficients, np.sqrt(np.diag(covariance))):
        out.write(f"{value:.17g},{sigma:.17g}\n")
