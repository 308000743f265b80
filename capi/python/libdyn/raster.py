"""Which triangle a pixel shows: a depth buffer in numpy.

Triangles are cut into rows of pixels, rows into pixels; of those of one pixel the nearest stays. Both cuts are exact, so that
triangles that share an edge leave no gap and no pixel to both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .arrays import Integers, Numbers

    Floats = NDArray[np.float32]


def _runs(counts: Integers) -> tuple[Integers, Integers]:
    """Of so many items each: whose each is, and which of its own."""
    whose = np.repeat(np.arange(len(counts)), counts)
    return whose, np.arange(len(whose)) - np.repeat(np.cumsum(counts) - counts, counts)


def raster(corners: Numbers, nearness: Numbers, width: int, height: int) -> tuple[Integers, Integers, Numbers]:
    """Pixels (row * width + column) that show something, the triangles that they show, and the shares (n, 3) of its corners.

    corners (n, 3, 2): in pixels, the middle of the first one at 0.5; nearness (n, 3): larger is nearer, linear over the picture.
    """
    x, y = corners[..., 0], corners[..., 1]
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    first = np.clip(np.ceil(y.min(1) - 0.5), 0, height).astype(np.int64)
    last = np.clip(np.ceil(y.max(1) - 0.5), 0, height).astype(np.int64)
    seen = (area != 0) & (x.max(1) > 0) & (x.min(1) < width)
    which, k = _runs(np.where(seen, last - first, 0))
    row = first[which] + k
    at = row + 0.5
    begin, end = np.full(len(which), np.inf), np.full(len(which), -np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        lower = np.where(y[:, i] <= y[:, j], i, j)  # an edge is cut at the same place by both of its triangles
        upper = i + j - lower
        n = np.arange(len(x))
        x0, y0, x1, y1 = x[n, lower], y[n, lower], x[n, upper], y[n, upper]
        slope = (x1 - x0) / np.where(y1 > y0, y1 - y0, 1)
        cut = (y0[which] <= at) & (at < y1[which])
        here = x0[which] + (at - y0[which]) * slope[which]
        begin, end = np.where(cut, np.minimum(begin, here), begin), np.where(cut, np.maximum(end, here), end)
    begin, end = np.where(begin <= end, begin, 0), np.where(begin <= end, end, 0)
    left = np.clip(np.ceil(begin - 0.5), 0, width).astype(np.int64)
    right = np.clip(np.ceil(end - 0.5), 0, width).astype(np.int64)
    of, k = _runs(np.maximum(right - left, 0))
    triangle, column = which[of], left[of] + k
    pixel = row[of] * width + column

    inverse = 1 / np.where(area == 0, 1, area)
    share = _affine(x, y, inverse)
    plane = np.einsum("nik,ni->kn", share, nearness)  # nearness = plane . (x, y, 1)
    near = plane[0][triangle] * (column + 0.5) + plane[1][triangle] * at[of] + plane[2][triangle]
    order = np.argsort(near.astype(np.float32), kind="stable")
    shown = np.full(width * height, -1, np.int64)
    shown[pixel[order]] = order  # of several the last stays
    pixels = np.flatnonzero(shown >= 0)
    best = shown[pixels]
    t = triangle[best]
    shares = np.einsum("nik,kn->ni", share[t], np.stack([pixels % width + 0.5, pixels // width + 0.5, np.ones(len(t))]))
    return pixels, t, np.clip(shares, 0, 1)


def _affine(x: Numbers, y: Numbers, inverse: Numbers) -> Numbers:
    """(n, 3, 3): the share of corner i at (x, y) is the product of row i and (x, y, 1)."""
    out = np.empty((len(x), 3, 3))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[:, i, 0] = (y[:, j] - y[:, k]) * inverse
        out[:, i, 1] = (x[:, k] - x[:, j]) * inverse
        out[:, i, 2] = (x[:, j] * y[:, k] - x[:, k] * y[:, j]) * inverse
    return out
