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

#: The picture in a notebook: how many bars it has, how wide and high it is in pixels.
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
    if not len(known) or not np.isfinite(known.max() - known.min()):
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
    """For Jupyter: counts, the smallest distance, and a histogram of the proven lower ends."""
    smallest = "" if self.smallest is None else f"<br>smallest: {self.smallest:.6g}"
    return (
        f"<div><b>verisq.Map</b>: {len(self)} rows, {self.wide} wider than {self.tolerance:.3g}, "
        f"by {escape(self.device)}{smallest}<br>{_histogram(self)}"
        "<br><small>how many rows have their proven lower end where; red: some of them are not proven outside</small></div>"
    )


def _are_of_triangles(rows: int, points: NDArray[Any], triangles: NDArray[Any], on: str | None) -> bool:
    """Whether there is a row a triangle, not one a vertex. Raises ValueError where that is neither, or not clear."""
    fitting = [name for name, count in (("vertices", len(points)), ("triangles", len(triangles))) if rows == count]
    if on in fitting:
        return on == "triangles"
    if on is not None or not fitting:
        raise ValueError(
            f"{rows} rows are not those of {on or 'vertices or triangles'}: "
            f"there are {len(points)} vertices and {len(triangles)} triangles"
        )
    if len(fitting) == 2:
        raise ValueError(f"{rows} vertices and as many triangles: say on='vertices' or on='triangles'")
    return fitting == ["triangles"]


def plot(
    mesh: Any,
    distances: Map | ArrayLike | None = None,
    *,
    on: str | None = None,
    ax: Any = None,
    label: str | None = None,
) -> Any:
    """Draws a mesh, coloured by what is proven of it, with matplotlib.

    mesh: a Mesh, or one of trimesh, meshio, pyvista, VTK or Open3D. distances: a Map of its vertices or of its
    triangles, whose lower ends are drawn, so that nothing looks farther away than is proven; or numbers. A triangle
    shows the smallest of its vertices, which says nothing of what lies between them. on: "vertices" or "triangles",
    where there are as many of both. ax: matplotlib's 3D axes, made
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
        is_of_triangles = _are_of_triangles(len(values), points, triangles, on)
        drawn.set_array(values if is_of_triangles else values[triangles].min(axis=1))
        drawn.set_cmap("viridis")
        ax.figure.colorbar(drawn, ax=ax, shrink=0.7, label=label or "lower end of the distance")
    ax.add_collection3d(drawn)
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(np.maximum(high - low, 1e-9 * (high - low).max() or 1.0))
    return ax


def to_pyvista(mesh: Any, distances: Map | None = None, *, on: str | None = None) -> Any:
    """The mesh as pyvista.PolyData, with the arrays lo, hi and status of a Map. Needs pyvista.

    to_pyvista(bone, verisq.map(stem, bone)).plot(scalars="lo") draws it. on: as in plot().
    """
    import pyvista

    points, triangles = _objects.mesh(mesh)
    if triangles is None:
        triangles = np.empty((0, 3), np.int64)
    faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    drawn = pyvista.PolyData(np.asarray(points, np.float64), faces)
    if distances is not None:
        is_of_triangles = _are_of_triangles(len(distances), points, triangles, on)
        data = drawn.cell_data if is_of_triangles else drawn.point_data
        for name in ("lo", "hi", "status"):
            data[name] = getattr(distances, name)
    return drawn


def make_tables() -> None:
    """Adds them to the class, whose rows the compiled part keeps."""
    Map.to_numpy = to_numpy
    Map.to_frame = to_frame
    Map._repr_html_ = _repr_html_
