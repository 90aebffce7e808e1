/// Maps of points to models with closed meshes: the host asks the meshes, a device may map the other primitives.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/uncertain_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/map.hpp"

namespace verisq {
namespace {

using verify::ClosedMesh;
using verify::MeshUnion;

/// Points that one thread takes at a time: enough for neighbours to be coherent.
constexpr std::size_t points_at_once = 1024;
/// Points between two polls of an interruption.
constexpr std::size_t chunk_size = std::size_t{1} << 15U;

void require_finite(std::span<const Point> points) {
  for (const auto& [x, y, z] : points) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      throw Error(ErrorKind::input, fmt::format("point ({}, {}, {}) is not finite", x, y, z));
  }
}

/// Says how depths are meant in a mesh whose triangles cross; empty where they are exact.
std::string note_of(const MeshUnion::Part& part, const Model& model) {
  const ClosedMesh::Facts& facts = part.mesh.mesh().facts();
  if (facts.depth_is_exact()) return "";
  return fmt::format(
      "{}: {} of {} triangles may cross, touch or coincide with others, or lie inside: distances outside and sides are "
      "exact, a depth inside is at least that to the nearest triangle, and may be more",
      name_of_primitive(model, part.primitive), facts.triangles - facts.outward - facts.inward, facts.triangles);
}

class MeshMap final : public ExactMap<Point> {
 public:
  MeshMap(const Model& model, const MapOptions& options)
      : options_(options),
        stop_(either(options.interrupted, options.out_of_time)),
        radius_(bounding_radius(model)),
        solids_(model) {
    if (options.method != Method::duality)
      throw Error(ErrorKind::input, "the published method: not supported for meshes");
    for (const MeshUnion::Part& part : solids_.meshes()) {
      if (const std::string note = note_of(part, model); !note.empty()) notice_ += (notice_.empty() ? "" : "; ") + note;
    }
    if (solids_.others()) {
      MapOptions of_others = options;
      of_others.covers = false;
      others_ = point_map(*solids_.others(), of_others);
    } else if (options.device != "auto" && options.device != "host") {
      throw Error(ErrorKind::input,
                  fmt::format("device {}: the host maps meshes, no other device yet", options.device));
    }
  }

  MapSummary map(const Source<Point>& source, const Sink<Point>& sink) override {
    MapSummary summary = empty_summary();
    summary.device = "host";
    std::vector<Point> points(chunk_size);
    while (!(summary.interrupted = options_.interrupted())) {
      points.resize(chunk_size);
      points.resize(source(points));
      if (points.empty()) break;
      require_finite(points);
      const MapRows others = others_ ? map_chunk<Point>(*others_, points) : MapRows{};
      if (others_) add_run(others.summary, summary);
      if (summary.interrupted) break;
      deliver(points, others, summary, sink);
    }
    if (!notice_.empty()) summary.notice += (summary.notice.empty() ? "" : "; ") + notice_;
    return summary;
  }

 private:
  static void add_run(const MapSummary& run, MapSummary& summary) {
    if (run.device != "host") summary.device = "host and " + run.device;
    summary.notice = run.notice;
    summary.device_seconds += run.device_seconds;
    summary.host_seconds += run.host_seconds;
    summary.interrupted = summary.interrupted || run.interrupted;
    summary.out_of_time = summary.out_of_time || run.out_of_time;
  }

  void deliver(std::span<const Point> points, const MapRows& others, MapSummary& summary,
               const Sink<Point>& sink) const {
    const auto start = std::chrono::steady_clock::now();
    std::vector<MapResult> rows(points.size());
    std::vector<Certificate> certificates(options_.certificates ? points.size() : 0);
    in_parallel((points.size() + points_at_once - 1) / points_at_once, [&](std::size_t part) {
      const std::size_t first = part * points_at_once;
      prove(points, first, std::min(points_at_once, points.size() - first), others, rows, certificates);
    });
    summary.host_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::uint64_t wide_before = summary.wide;
    count(summary, rows);
    if (summary.wide > wide_before && options_.out_of_time && options_.out_of_time()) summary.out_of_time = true;
    sink(points, rows, certificates);
  }

  void prove(std::span<const Point> points, std::size_t first, std::size_t size, const MapRows& others,
             std::span<MapResult> rows, std::span<Certificate> certificates) const {
    const std::size_t meshes = solids_.meshes().size();
    std::vector<ClosedMesh::Distance> by_mesh(meshes * size);
    for (std::size_t k = 0; k < meshes; ++k) {
      solids_.meshes()[k].mesh.signed_distances(points.subspan(first, size),
                                                std::span(by_mesh).subspan(k * size, size));
    }
    std::vector<ClosedMesh::Distance> to_meshes(meshes);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t k = 0; k < meshes; ++k) to_meshes[k] = by_mesh[k * size + i];
      const std::size_t n = first + i;
      std::optional<CertifiedEnclosure> to_others;
      if (others_) to_others = {others.results[n].distance, {}};
      if (others_ && options_.certificates) to_others->certificate = others.certificates[n];
      CertifiedEnclosure found = solids_.joined(points[n], to_meshes, to_others);
      if (!is_good(points[n], found.distance))
        solids_.narrow(points[n], options_.tolerance, options_.certificates, stop_, found);
      rows[n] = {found.distance, is_good(points[n], found.distance) ? Status::host_verified : Status::wide};
      if (options_.certificates) certificates[n] = std::move(found.certificate);
    }
  }

  /// At most the tolerance wide; if 0 requests the tightest, as tight as maps of superquadrics are at best.
  [[nodiscard]] bool is_good(const Point& point, const Enclosure& found) const {
    return verified(found, options_.tolerance > 0.0 ? options_.tolerance : tightest_width(point, found, radius_));
  }

  MapOptions options_;
  std::function<bool()> stop_;
  double radius_;
  MeshUnion solids_;
  std::string notice_;
  std::unique_ptr<ExactMap<Point>> others_;
};

/// Set operations other than the union: the host searches each point.
class MeshSetProver {
 public:
  MeshSetProver(const Model& model, const MapOptions& options)
      : tolerance_(options.tolerance),
        radius_(bounding_radius(model)),
        stop_(either(options.interrupted, options.out_of_time)),
        distance_(std::make_unique<SignedDistance>(model)) {
    if (options.method != Method::duality)
      throw Error(ErrorKind::input, "the published method: not supported for meshes");
    if (options.certificates)
      throw Error(ErrorKind::input, "certificates: not supported for set operations with meshes, but for their union");
    refuse_empty(model, *distance_, options.interrupted);
    coarse_ = std::make_unique<verify::CoarseDistance>(coarse_distance(model, *distance_, options.interrupted));
  }

  void check(const Point& point) const { require_finite(std::span(&point, 1)); }
  [[nodiscard]] std::string describe(const Point& p) const { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }
  [[nodiscard]] bool at_limit(const Point& /*point*/, const Enclosure& found) const {
    return verified(found, tightest_inside * radius_);
  }
  /// A search that finds no point of the solid leaves an end infinite: rough distances bound it.
  [[nodiscard]] CertifiedEnclosure prove(const Point& point) const {
    return {verify::intersection((*distance_)(point, tolerance_, stop_), (*coarse_)(point),
                                 [&] { return "the distance at " + describe(point); }),
            {}};
  }
  [[nodiscard]] CertifiedEnclosure coarse(const Point& point) const { return {(*coarse_)(point), {}}; }
  [[nodiscard]] static bool witnessed(const Point& /*point*/, double /*hi*/, const Certificate& /*none*/) {
    return false;
  }

 private:
  double tolerance_;
  double radius_;
  std::function<bool()> stop_;
  std::unique_ptr<SignedDistance> distance_;
  std::unique_ptr<verify::CoarseDistance> coarse_;
};

}  // namespace

std::unique_ptr<ExactMap<Point>> mesh_map(const Model& model, const MapOptions& options) {
  if (verify::is_union(model)) return std::make_unique<MeshMap>(model, options);
  return std::make_unique<PreparedMap<Point, MeshSetProver>>(MeshSetProver(model, options), options, model,
                                                             PreparedMap<Point, MeshSetProver>::MakeBatch());
}

}  // namespace verisq
