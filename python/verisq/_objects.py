"""Objects of other packages as arrays: meshes of trimesh, meshio, pyvista, VTK and Open3D, poses as matrices.

Their members tell what they are, so that none of those packages is needed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: How far the rotation of a 4 x 4 matrix may be from a rotation, in each number of R^T R.
MOST_DISTORTION = 1e-6


def vertices(thing: Any) -> NDArray[Any]:
    """(N, 3): all vertices, whatever triangles there are."""
    if hasattr(thing, "GetPoints"):
        return _of_vtk(thing.GetPoints().GetData()) if thing.GetPoints() else np.empty((0, 3))
    return np.asarray(thing.vertices if hasattr(thing, "vertices") else thing.points)


def mesh(thing: Any) -> tuple[NDArray[Any], NDArray[Any] | None]:
    """Vertices (N, 3) and triangles (M, 3); no triangles for a cloud. Raises ValueError for other polygons."""
    return vertices(thing), _triangles(thing)


def corners(thing: Any) -> NDArray[Any]:
    """(M, 3, 3): the corners of each triangle."""
    points, triangles = mesh(thing)
    if triangles is None:
        raise ValueError(f"{_name(thing)} has no triangles")
    return points[triangles]


def pose(thing: Any) -> NDArray[np.float64]:
    """A pose as seven numbers: translation, and quaternion [w, x, y, z].

    thing: seven numbers; a rigid 4 x 4 matrix, of NumPy or VTK; a Rotation of SciPy; or a pair of a rotation (SciPy's,
    or 3 x 3) and a translation. `distance` and `map_poses` are exact for these seven numbers, from which a matrix
    differs by its rounding; Model.posed and pose= round the moved model once more. Raises ValueError for a matrix that
    scales, shears or mirrors, and for more than one pose.
    """
    found = poses(_one(thing))
    if found.shape != (1, 7):
        raise ValueError(f"a pose must be an array of shape (7,) or (4, 4), not {np.shape(_one(thing))[1:]}")
    return found[0]


def poses(thing: Any) -> NDArray[np.float64]:
    """Many poses as an array (N, 7): from one, from matrices (N, 4, 4), or from a stack of SciPy's Rotation."""
    if hasattr(thing, "as_quat"):
        x, y, z, w = np.atleast_2d(thing.as_quat()).T
        return np.stack([np.zeros_like(w), np.zeros_like(w), np.zeros_like(w), w, x, y, z], axis=1)
    array = np.asanyarray(thing)
    if array.shape[-2:] != (4, 4) or array.ndim != 3:
        return array
    _require_rigid(array)
    return np.concatenate([array[:, :3, 3], _quaternions(array[:, :3, :3])], axis=1)


def _one(thing: Any) -> Any:
    """The same as a stack of one."""
    if hasattr(thing, "as_quat"):
        if np.ndim(thing.as_quat()) != 1:
            raise ValueError(f"a pose must be one rotation, not {len(thing)}")
        return thing
    if hasattr(thing, "GetElement"):  # VTK's
        return np.array([[[thing.GetElement(i, j) for j in range(4)] for i in range(4)]])
    if isinstance(thing, (list, tuple)) and len(thing) == 2:
        rotation, translation = thing
        matrix = np.eye(4)
        matrix[:3, :3] = rotation.as_matrix() if hasattr(rotation, "as_matrix") else rotation
        matrix[:3, 3] = translation
        return matrix[np.newaxis]
    return np.asanyarray(thing)[np.newaxis]


def _require_rigid(matrices: NDArray[Any]) -> None:
    rotations = matrices[:, :3, :3]
    with np.errstate(all="ignore"):  # what is not finite is refused
        distortion = np.abs(np.swapaxes(rotations, 1, 2) @ rotations - np.eye(3)).max(axis=(1, 2))
        is_rigid = (distortion <= MOST_DISTORTION) & (np.linalg.det(rotations) > 0.0)
        is_rigid &= (matrices[:, 3] == [0.0, 0.0, 0.0, 1.0]).all(axis=1)
    if not is_rigid.all():
        raise ValueError(
            f"pose {np.flatnonzero(~is_rigid)[0]}: a matrix must turn and move, and neither scale, shear nor mirror"
        )


def _quaternions(rotations: NDArray[Any]) -> NDArray[np.float64]:
    """[w, x, y, z] of each: by the largest of the four, so that nothing cancels (Shepperd 1978)."""
    r = rotations.astype(np.float64)
    xx, yy, zz = r[:, 0, 0], r[:, 1, 1], r[:, 2, 2]
    # Four times the products of all pairs of components: each row is the quaternion times one of its components.
    products = np.empty((len(r), 4, 4))
    products[:, 0, 0] = 1.0 + xx + yy + zz
    products[:, 1, 1] = 1.0 + xx - yy - zz
    products[:, 2, 2] = 1.0 - xx + yy - zz
    products[:, 3, 3] = 1.0 - xx - yy + zz
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        products[:, 0, i] = products[:, i, 0] = r[:, k - 1, j - 1] - r[:, j - 1, k - 1]
        products[:, i, j] = products[:, j, i] = r[:, i - 1, j - 1] + r[:, j - 1, i - 1]
    largest = np.argmax(np.diagonal(products, axis1=1, axis2=2), axis=1)
    chosen = products[np.arange(len(r)), largest]
    return chosen / np.linalg.norm(chosen, axis=1, keepdims=True)


def _triangles(thing: Any) -> NDArray[Any] | None:
    if hasattr(thing, "GetPolys"):  # VTK's polygons, and pyvista's
        if thing.GetStrips() and thing.GetStrips().GetNumberOfCells():
            raise ValueError(f"{_name(thing)} has strips: triangulate it")
        polygons = thing.GetPolys()
        if polygons is None or polygons.GetNumberOfCells() == 0:
            return None
        ends = _of_vtk(polygons.GetOffsetsArray())
        if (np.diff(ends) != 3).any():
            raise ValueError(f"{_name(thing)} has polygons that are no triangles: triangulate it")
        return _of_vtk(polygons.GetConnectivityArray()).reshape(-1, 3)
    if hasattr(thing, "GetCells"):  # VTK's grids, and pyvista's
        raise ValueError(f"{_name(thing)} is no surface: extract it")
    for name in ("faces", "triangles"):  # trimesh's and Open3D's
        if hasattr(thing, name):
            return np.asarray(getattr(thing, name))
    if hasattr(thing, "cells"):
        return _triangles_of_cells(thing)
    return None


def _triangles_of_cells(thing: Any) -> NDArray[Any] | None:
    """meshio's: a list of blocks, each of one type. Lines and single vertices are no part of a surface."""
    found = []
    for block in thing.cells:
        if block.type == "triangle":
            found.append(np.asarray(block.data))
        elif block.type not in ("line", "vertex"):
            raise ValueError(f"{_name(thing)} has cells of type {block.type}: take its surface, as triangles")
    return np.concatenate(found) if found else None


def _of_vtk(array: Any) -> NDArray[Any]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(array)


def _name(thing: Any) -> str:
    return f"{type(thing).__module__.split('.')[0]}'s {type(thing).__name__}"
