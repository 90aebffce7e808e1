/// What is made of a femur's landmarks: an implant's own points, axes as a model, regions of the mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::features {

// The points of an implant that say what it changes of a femur, where its file does not name them all.

struct ImplantPoints {
  FemurLandmarks points;
  std::vector<std::string> notes;  ///< of head and neck, where each comes from
};

/// A primitive and the point that is its centre.
struct NamedCentre {
  std::string name;
  Point centre;
};

/// Primitives whose centres are head and neck, before what the file names; "": the file's, else those of the usual
/// names, "head" and "neck".
struct HeadAndNeck {
  std::string head = {};
  std::string neck = {};
};

/// `named`: what the file names. Precondition: primitives that are asked for by name are among the centres.
[[nodiscard]] ImplantPoints implant_points(const FemurLandmarks& named, const std::vector<NamedCentre>& centres,
                                           const HeadAndNeck& asked = {});

// Head, axes and lines of a femur as a model of thin rods, for pictures.

/// The name of the head's sphere.
inline constexpr const char* drawn_head = "head";

/// The head's sphere, and a rod along each axis that the landmarks make: no primitives where there is none of these.
[[nodiscard]] Model drawn_axes(const FemurLandmarks& landmarks);

// Which part of a bone each triangle of its mesh belongs to: to say where something is.

/// A triangle belongs where its centroid lies; `names` in the order of the indices.
struct Regions {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_triangles;
};

/// Head (to 1.15 of its radius about its centre), neck (about its axis, from the head towards the shaft axis, to 0.9 of
/// that radius), shaft (between its two points, along it), condyles (below) and trochanters (all else above). Throws
/// Error(input) unless the landmarks have head, neck and shaft.
[[nodiscard]] Regions femur_regions(const Mesh& mesh, const FemurLandmarks& landmarks);

/// Equal parts of the extent along the direction in which the surface spreads most, whose largest coordinate is
/// positive; named by where they begin and end. Precondition: count > 0, the mesh has triangles.
[[nodiscard]] Regions parts_along(const Mesh& mesh, std::uint32_t count);

}  // namespace verisq::features
