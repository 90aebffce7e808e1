"""Maps as tables and pictures: structured arrays, pandas, Jupyter, matplotlib and pyvista."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _objects
from ._verisq import Map

#: One row of Map.to_numpy().
ROW = np.dtype([("lo", np.float64), ("hi", np.float64), ("status", np.uint8)])

#: Of the picture in a notebook: how many bars, and how wide and high it is in pixels.
BARS, WIDTH, HEIGHT = 40, 400, 80


def to_numpy(self: Map) -> NDArray[Any]:
    """to_numpy() -> structured array (N,) with the fields lo, hi and status: a copy."""
    rows = np.empty(len(self), ROW)
    rows["lo"], rows["hi"], rows["status"] = self
    return rows


def to_frame(self: Map) -> Any:
    """to_frame() -> pandas.DataFrame with the columns lo, hi and status. Needs pandas."""
    import pandas

    return pandas.DataFrame({"lo": self.lo, "hi": self.hi, "status": self.status})


def _histogram(self: Map) -> str:
    """Bars of how many rows have their lower end where: SVG."""
    known = self.lo[np.isfinite(self.lo)]
    if not len(known):
        return ""
    counts, edges = np.histogram(known, bins=BARS)
    step = WIDTH / BARS
    bars = "".join(
        f'<rect x="{i * step:.1f}" y="{HEIGHT * (1 - count / counts.max()):.1f}" width="{step - 1:.1f}" '
        f'height="{HEIGHT * count / counts.max():.1f}" fill="{"#c0392b" if edges[i] < 0 else "#2c7fb8"}"/>'
        for i, count in enumerate(counts)
    )
    return (
        f'<svg width="{WIDTH}" height="{HEIGHT + 18}">{bars}'
        f'<text y="{HEIGHT + 14}" font-size="12">{edges[0]:.4g}</text>'
        f'<text x="{WIDTH}" y="{HEIGHT + 14}" font-size="12" text-anchor="end">{edges[-1]:.4g}</text></svg>'
    )


def _repr_html_(self: Map) -> str:
    """What Jupyter shows: counts, the smallest distance, and a histogram of the proven lower ends."""
    smallest = "" if self.smallest is None else f"<br>smallest: [{self.smallest.lo:.6g}, {self.smallest.hi:.6g}]"
    return (
        f"<div><b>verisq.Map</b>: {len(self)} rows, {self.wide} wider than {self.tolerance:.3g}, "
        f"by {escape(self.device)}{smallest}<br>{_histogram(self)}"
        "<br><small>how many rows have their proven lower end where; red: below 0, perhaps inside</small></div>"
    )


def _face_values(values: NDArray[np.float64], points: NDArray[Any], triangles: NDArray[Any]) -> NDArray[np.float64]:
    """One value a triangle: its own, or the smallest of its vertices."""
    if len(values) == len(triangles):
        return values
    if len(values) == len(points):
        return values[triangles].min(axis=1)
    raise ValueError(f"{len(values)} rows are neither those of {len(points)} vertices nor of {len(triangles)} triangles")


def plot(mesh: Any, distances: Map | ArrayLike | None = None, *, ax: Any = None, label: str = "distance") -> Any:
    """Draws a mesh, coloured by what is proven of it, with matplotlib.

    mesh: a Mesh, or one of trimesh, meshio, pyvista, VTK or Open3D. distances: a Map of its vertices or of its
    triangles, whose lower ends are drawn, so that nothing looks farther away than is proven; or numbers. A triangle
    shows the smallest of its vertices, which says nothing of what lies between them. ax: matplotlib's 3D axes, made
    anew without. Returns the axes. Many triangles are slow: pyvista draws millions (to_pyvista).
    """
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    points, triangles = _objects.mesh(mesh)
    if triangles is None:
        raise ValueError("a cloud has no triangles to draw")
    if ax is None:
        ax = plt.figure().add_subplot(projection="3d")
    drawn = Poly3DCollection(np.asarray(points, np.float64)[triangles])
    if distances is None:
        drawn.set_facecolor("lightgray")
    else:
        values = distances.lo if isinstance(distances, Map) else np.asarray(distances, np.float64)
        drawn.set_array(_face_values(values, points, triangles))
        drawn.set_cmap("viridis")
        ax.figure.colorbar(drawn, ax=ax, shrink=0.7, label=label)
    ax.add_collection3d(drawn)
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(np.maximum(high - low, 1e-9 * (high - low).max() or 1.0))
    return ax


def to_pyvista(mesh: Any, distances: Map | None = None) -> Any:
    """The mesh as pyvista.PolyData, with the arrays lo, hi and status of a Map. Needs pyvista.

    to_pyvista(bone, verisq.map(stem, bone)).plot(scalars="lo") draws it.
    """
    import pyvista

    points, triangles = _objects.mesh(mesh)
    faces = np.empty((0,), np.int64)
    if triangles is not None:
        faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    drawn = pyvista.PolyData(np.asarray(points, np.float64), faces)
    if distances is not None:
        data = drawn.cell_data if triangles is not None and len(distances) == len(triangles) else drawn.point_data
        for name in ("lo", "hi", "status"):
            data[name] = getattr(distances, name)
    return drawn


def make_tables() -> None:
    """Adds them to the class, whose rows the compiled part keeps."""
    Map.to_numpy = to_numpy
    Map.to_frame = to_frame
    Map._repr_html_ = _repr_html_
