/// Areas of a cavity: points sorted into boxes, and labels of a mesh's vertices.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <new>
#include <utility>
#include <verisq/clearance.hpp>
#include <verisq/error.hpp>

#include "host/files/mesh_file.hpp"
#include "host/files/model_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

bool holds(const AreaBox& box, const Point& point) {
  const auto within = [&](std::size_t k) { return box.lower[k] <= point[k] && point[k] <= box.upper[k]; };
  return within(0) && within(1) && within(2);
}

}  // namespace

Cavity cavity(std::vector<Point> points, std::span<const AreaBox> boxes, double weight_elsewhere) {
  Cavity result{std::move(points), {}, {}};
  for (const AreaBox& box : boxes) result.areas.push_back(box.area);
  result.area_of.reserve(result.points.size());
  for (const Point& point : result.points) {
    const auto first = std::ranges::find_if(boxes, [&](const AreaBox& box) { return holds(box, point); });
    result.area_of.push_back(static_cast<std::uint32_t>(first - boxes.begin()));
  }
  const bool all_within = std::ranges::none_of(result.area_of, [&](std::uint32_t k) { return k == boxes.size(); });
  if (!all_within) result.areas.push_back({std::string(elsewhere), weight_elsewhere});
  return result;
}

namespace {

/// Position of each value among the distinct ones, in ascending order.
std::map<std::int64_t, std::uint32_t> ranks(std::span<const std::int64_t> labels) {
  std::map<std::int64_t, std::uint32_t> rank;
  for (const std::int64_t label : labels) rank.emplace(label, 0);
  std::uint32_t next = 0;
  for (auto& entry : rank) entry.second = next++;
  return rank;
}

LabelledMesh read_labels(const std::filesystem::path& path, const std::string& property) {
  if (lower_case(path.extension().string()) != ".ply") {
    throw Error(ErrorKind::input, fmt::format("{}: labels of vertices are read from .ply only", path.string()));
  }
  InputFile file(path);
  if (file.size() == 0) file.fail_whole("not a regular file: a mesh needs a known size");
  try {
    return read_labelled_ply(file, property);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failure, fmt::format("{}: not enough memory for this mesh", path.string()));
  }
}

}  // namespace

Cavity labelled_cavity(std::vector<Point> points, std::span<const std::int64_t> labels, std::span<const Area> weights) {
  const auto rank = ranks(labels);
  Cavity cavity{std::move(points), {}, {}};
  for (const auto& [label, index] : rank) cavity.areas.push_back({std::to_string(label), 1.0});
  for (const Area& weight : weights) {
    const auto area = std::ranges::find(cavity.areas, weight.name, &Area::name);
    if (area == cavity.areas.end()) {
      throw Error(ErrorKind::input,
                  fmt::format("no vertex has the value {}, which has a weight", in_quotes(weight.name)));
    }
    area->weight = weight.weight;
  }
  cavity.area_of.reserve(labels.size());
  for (const std::int64_t label : labels) cavity.area_of.push_back(rank.at(label));
  return cavity;
}

Cavity read_labelled_cavity(const std::filesystem::path& mesh, const std::string& property,
                            std::span<const Area> weights) {
  LabelledMesh labelled = read_labels(mesh, property);
  try {
    return labelled_cavity(std::move(labelled.mesh.vertices), labelled.labels, weights);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: property {}: {}", mesh.string(), in_quotes(property), error.what()));
  }
}

}  // namespace verisq
