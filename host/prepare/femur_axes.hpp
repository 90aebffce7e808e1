/// Results from a femur's landmarks: an implant's own points, axes as a model, regions of the mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::features {

// The points of an implant that determine its changes of a femur, if its file does not name them all.

struct ImplantPoints {
  FemurLandmarks points;
  std::vector<std::string> notes;  ///< the origins of the head's and the neck's point
};

/// A primitive and the point that is its centre.
struct NamedCentre {
  std::string name;
  Point centre;
};

/// The primitives whose centres are head and neck; they take precedence over the file's points. "": the file's points,
/// else the primitives of the usual names, "head" and "neck".
struct HeadAndNeck {
  std::string head = {};
  std::string neck = {};
};

/// `named` are the file's points. Precondition: primitives requested by name are among the centres.
[[nodiscard]] ImplantPoints implant_points(const FemurLandmarks& named, const std::vector<NamedCentre>& centres,
                                           const HeadAndNeck& asked = {});

// Head, axes and lines of a femur as a model of thin rods, for pictures.

/// The name of the head's sphere.
inline constexpr const char* drawn_head = "head";

/// The head's sphere, and a rod along each axis that the landmarks determine: no primitives if there are none of these.
[[nodiscard]] Model drawn_axes(const FemurLandmarks& landmarks);

// The part of a bone to which each triangle of its mesh belongs: for statements about places.

/// A triangle belongs to the part that contains its centroid; `names` in the order of the indices.
struct Regions {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_triangles;
};

/// Head (to 1.15 of its radius about its centre), neck (about its axis, from the head towards the shaft axis, to 0.9 of
/// that radius), shaft (between its two points, along it), condyles (below) and trochanters (all else above). Throws
/// Error(input) unless the landmarks have head, neck and shaft.
[[nodiscard]] Regions femur_regions(const Mesh& mesh, const FemurLandmarks& landmarks);

/// Equal parts of the extent along the direction in which the surface spreads most, whose largest coordinate is
/// positive; named by their beginnings and ends. Precondition: count > 0, the mesh has triangles.
[[nodiscard]] Regions parts_along(const Mesh& mesh, std::uint32_t count);

}  // namespace verisq::features
