"""Guaranteed distances: every answer is an interval [lo, hi] that contains the exact distance.

    import numpy as np, verisq
    stem = verisq.Model.load("stem.json")
    lo, hi, status = verisq.map(stem, points)  # points: an array of shape (N, 3), in the model's units

Models are posed superquadrics, bent, tapered or neither, and closed meshes; unions, intersections and differences of
them. Distances of points are signed: positive outside, negative inside. A row that is wider than the tolerance is wide,
and valid.

Models and meshes
    Model, Mesh, mesh_of_model; meshes of trimesh, meshio, pyvista, VTK and Open3D are taken, too; pose
Many queries, from arrays to arrays
    map, map_triangles, map_poses, map_chunks; Mapper, TriangleMapper, PoseMapper keep a model ready; Map, Status;
    PoseUncertainty where a place is not exactly known
Closest points, normals and gradients of many points; closest points of two models in many poses
    closest_points, ClosestPointMap; closest_pairs, ClosestPairMap
One query, proven by the host
    SignedDistance, distance, Enclosure, Undecided; distance_along, PathDistance for a model that moves
What proves an answer again
    Answer, Claim for certificate files of all kinds; Checker, Certificates, Findings, Verdict for rows of maps;
    certified_distance of two models, certified_distance_along a path
Whole surfaces and solids
    deviation, certified_deviation, mesh_clearance, prove_containment, octree, recover
Implants
    fit; map_along, certified_map_along, certified_mesh_clearance, straight_path, removed_volume,
    certified_removed_volume for their way in
Stance
    StanceModel, Equilibrium, CertifiedEquilibrium, Stability, Motion, Bounce
Femurs
    detect_femur, femur_features
Pictures
    plot, to_pyvista; Map.to_numpy, Map.to_frame
Devices and errors
    devices, Error

Lengths are in the model's units throughout, angles in degrees. The contract: docs/python.md, docs/formats.md §1.
"""

import enum as _enum

from . import _verisq
from ._chunks import map_chunks
from ._display import make_tables, plot, to_pyvista
from ._enclosures import Undecided, make_numbers
from ._objects import pose
from ._verisq import (
    Answer,
    AreaClearance,
    AreaStatistics,
    AreaWithin,
    Bounce,
    Certificates,
    CertifiedBound,
    CertifiedContact,
    CertifiedDeviation,
    CertifiedEquilibrium,
    CertifiedMeshClearance,
    CertifiedPair,
    CertifiedPath,
    CertifiedRemovedVolume,
    CertifiedWay,
    Checker,
    Claim,
    ClosestPairMap,
    ClosestPointMap,
    ClosestPoints,
    ContainmentProof,
    Deviation,
    Device,
    DistanceStatistics,
    DistanceSummary,
    Enclosure,
    Equilibrium,
    Error,
    EstimatedDeviation,
    Feature,
    Femur,
    FemurFeatures,
    Findings,
    Fit,
    FitBound,
    FitCondition,
    FitTrial,
    Map,
    Mapper,
    Mesh,
    MeshClearance,
    Model,
    Motion,
    Octree,
    Pair,
    PathDistance,
    PoseMapper,
    PoseUncertainty,
    Recovery,
    RecoveryStage,
    RemovedVolume,
    SignedDistance,
    Stability,
    StanceModel,
    TriangleMapper,
    __version__,
    certified_deviation,
    certified_distance,
    certified_distance_along,
    certified_map_along,
    certified_mesh_clearance,
    certified_removed_volume,
    closest_pairs,
    closest_points,
    detect_femur,
    deviation,
    devices,
    distance,
    distance_along,
    femur_features,
    fit,
    map,
    map_along,
    map_poses,
    map_triangles,
    mesh_clearance,
    mesh_of_model,
    octree,
    prove_containment,
    recover,
    removed_volume,
    straight_path,
)


class Status(_enum.IntEnum):
    """Who proved a row of a map."""

    DEVICE_VERIFIED = 0  #: at most the tolerance wide, proven by the device's kernels
    HOST_VERIFIED = 1  #: left open by the device, proven by the host
    WIDE = 2  #: valid, but wider than the tolerance


class CubeColour(_enum.IntEnum):
    """What is proven of a cube of an octree."""

    OUTSIDE = 0  #: no point of it lies in the solid
    UNDECIDED = 1  #: neither
    INSIDE = 2  #: all of it lies in the solid


class Verdict(_enum.IntEnum):
    """What a Checker says of a row."""

    PROVED = 0  #: the certificate proves both ends
    REFUTED = 1  #: the exact distance is proven to lie outside the row, or lo > hi
    UNPROVED = 2  #: neither: the certificate proves less than the row claims


__all__ = [
    "Answer",
    "AreaClearance",
    "AreaStatistics",
    "AreaWithin",
    "Bounce",
    "Certificates",
    "CertifiedBound",
    "CertifiedContact",
    "CertifiedDeviation",
    "CertifiedEquilibrium",
    "CertifiedMeshClearance",
    "CertifiedPair",
    "CertifiedPath",
    "CertifiedRemovedVolume",
    "CertifiedWay",
    "Checker",
    "Claim",
    "ClosestPairMap",
    "ClosestPointMap",
    "ClosestPoints",
    "ContainmentProof",
    "CubeColour",
    "Deviation",
    "Device",
    "DistanceStatistics",
    "DistanceSummary",
    "Enclosure",
    "Equilibrium",
    "Error",
    "EstimatedDeviation",
    "Feature",
    "Femur",
    "FemurFeatures",
    "Findings",
    "Fit",
    "FitBound",
    "FitCondition",
    "FitTrial",
    "Map",
    "Mapper",
    "Mesh",
    "MeshClearance",
    "Model",
    "Motion",
    "Octree",
    "Pair",
    "PathDistance",
    "PoseMapper",
    "PoseUncertainty",
    "Recovery",
    "RecoveryStage",
    "RemovedVolume",
    "SignedDistance",
    "Stability",
    "StanceModel",
    "Status",
    "TriangleMapper",
    "Undecided",
    "Verdict",
    "__version__",
    "certified_deviation",
    "certified_distance",
    "certified_distance_along",
    "certified_map_along",
    "certified_mesh_clearance",
    "certified_removed_volume",
    "closest_pairs",
    "closest_points",
    "detect_femur",
    "deviation",
    "devices",
    "distance",
    "distance_along",
    "femur_features",
    "fit",
    "map",
    "map_along",
    "map_chunks",
    "map_poses",
    "map_triangles",
    "mesh_clearance",
    "mesh_of_model",
    "octree",
    "plot",
    "pose",
    "prove_containment",
    "recover",
    "removed_volume",
    "straight_path",
    "to_pyvista",
]

make_numbers()
make_tables()

# To users they are verisq.Model, verisq.map, whatever file they are in.
for _name in __all__:
    _thing = globals()[_name]
    if getattr(_thing, "__module__", "").startswith(__name__ + "._"):
        try:
            _thing.__module__ = __name__
        except AttributeError:  # built-in functions keep theirs
            pass
del _name, _thing
