/// Maps of points to a closed mesh as a solid, by the host.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "host/maps/certified_rows.hpp"
#include "host/threads/parallel.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verisq/error.hpp"
#include "verisq/map.hpp"

namespace verisq {
namespace {

using verify::ClosedMesh;

/// Points that one thread takes at a time: enough for neighbours to be coherent.
constexpr std::size_t points_at_once = 1024;
/// Points between two polls of an interruption.
constexpr std::size_t chunk_size = std::size_t{1} << 15U;

void refuse_what_meshes_lack(const MapOptions& options) {
  const auto refuse = [](const char* what) {
    throw Error(ErrorKind::input, fmt::format("a mesh as the model: {}", what));
  };
  if (options.device != "auto" && options.device != "host") refuse("the host maps it: no other device yet");
  if (options.certificates) refuse("has no certificates yet");
  if (options.method != Method::duality) refuse("the published method knows superquadrics alone");
  if (options.point_radius > 0.0 || options.pose_uncertainty) refuse("points and places must be exact so far");
}

void require_finite(std::span<const Point> points) {
  for (const auto& [x, y, z] : points) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      throw Error(ErrorKind::input, fmt::format("point ({}, {}, {}) is not finite", x, y, z));
  }
}

}  // namespace

struct MeshMapper::State {
  State(const Mesh& m, const MapOptions& o) : solid(m), options(o) {
    const Point& lower = solid.tree().lower();
    const Point& upper = solid.tree().upper();
    for (std::size_t i = 0; i < 3; ++i) size = std::max({size, std::abs(lower[i]), std::abs(upper[i])});
  }

  /// A tolerance of 0 asks for the tightest: that is a share of the largest coordinate, as for superquadrics.
  [[nodiscard]] bool is_verified(const Point& point, const Enclosure& distance) const {
    const double largest = std::max({size, std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
    return distance.width() <= (options.tolerance > 0.0 ? options.tolerance : tightest_outside * largest);
  }

  void prove(std::span<const Point> points, std::span<MapResult> rows) const {
    std::vector<ClosedMesh::Distance> distances(points.size());
    solid.signed_distances(points, distances);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Enclosure& found = distances[i].signed_distance;
      rows[i] = {found, is_verified(points[i], found) ? Status::host_verified : Status::wide};
    }
  }

  ClosedMesh solid;
  MapOptions options;
  double size = 0.0;  ///< the largest coordinate
};

MeshMapper::MeshMapper(const Mesh& solid, const MapOptions& options) {
  refuse_what_meshes_lack(options);
  state_ = std::make_unique<State>(solid, options);
}

MeshMapper::~MeshMapper() = default;
MeshMapper::MeshMapper(MeshMapper&&) noexcept = default;
MeshMapper& MeshMapper::operator=(MeshMapper&&) noexcept = default;

MapSummary MeshMapper::map(const Source<Point>& source, const Sink<Point>& sink) const {
  MapSummary summary = empty_summary();
  summary.device = "host";
  std::vector<Point> points(chunk_size);
  std::vector<MapResult> rows(chunk_size);
  while (!(summary.interrupted = state_->options.interrupted())) {
    const std::size_t count = source(points);
    if (count == 0) break;
    const auto chunk = std::span<const Point>(points).first(count);
    require_finite(chunk);
    const auto start = std::chrono::steady_clock::now();
    in_parallel((count + points_at_once - 1) / points_at_once, [&](std::size_t part) {
      const std::size_t first = part * points_at_once;
      const std::size_t some = std::min(points_at_once, count - first);
      state_->prove(chunk.subspan(first, some), std::span(rows).subspan(first, some));
    });
    summary.host_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto finished = std::span<const MapResult>(rows).first(count);
    verisq::count(summary, finished);
    sink(chunk, finished, {});
  }
  return summary;
}

MeshMapper::Facts MeshMapper::facts() const {
  const ClosedMesh::Facts& facts = state_->solid.facts();
  return {facts.triangles, facts.unclean, facts.depth_is_exact()};
}

}  // namespace verisq
