/// The surface that an implant is fitted into: points of the bone, grouped into areas of different weight.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/clearance_report.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Every index of `area_of` is below `areas.size()`; one a point. The triangles, whose indices are below
/// `points.size()`, are the surface that the implant must not cut between the points; there may be none.
struct Cavity {
  std::vector<Point> points;
  std::vector<Area> areas;
  std::vector<std::uint32_t> area_of;
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};

/// An area as a box in the coordinates of the mesh, faces included: key `areas` of a model file. Precondition: lower
/// corner at most the upper one, all finite.
struct AreaBox {
  Area area;
  Point lower;
  Point upper;
  [[nodiscard]] bool operator==(const AreaBox&) const = default;
};

/// The areas of a model file, none where it has no key `areas`. Throws Error(input) as `read_model`.
[[nodiscard]] std::vector<AreaBox> read_areas(const std::filesystem::path& model);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] std::vector<AreaBox> parse_areas(std::string_view json, std::string_view name);

/// Every point belongs to the first box that holds it; where there is none, to a last area "elsewhere" of weight
/// `weight_elsewhere`, which is there only if it has a point.
[[nodiscard]] Cavity cavity(std::vector<Point> points, std::span<const AreaBox> boxes, double weight_elsewhere = 1.0);

/// The areas are the values of the points' labels, one each, in ascending order, named by their numbers; a value
/// without a weight in `weights` (area names are the numbers) has weight 1. Throws Error(input) for a weight of a value
/// that does not occur.
[[nodiscard]] Cavity labelled_cavity(std::vector<Point> points, std::span<const std::int64_t> labels,
                                     std::span<const Area> weights);

/// The same of the vertices of a `.ply` file, whose labels are an integer property of theirs. Throws Error(input) for
/// another format, an absent property or one that is not an integer type, and likewise.
[[nodiscard]] Cavity read_labelled_cavity(const std::filesystem::path& mesh, const std::string& property,
                                          std::span<const Area> weights);

}  // namespace verisq
