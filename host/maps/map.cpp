/// Maps of points and of triangles.
#include "verisq/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/device/device_model.hpp"
#include "host/device/query_batches.hpp"
#include "host/device/solid_model.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/piped_map.hpp"
#include "host/maps/uncertain_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/displaced_point.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/triangle_pieces.hpp"
#include "verify/solids/model.hpp"
#include "verisq/device.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"

namespace verisq {
namespace {

/// The addresses of a column's values, from the lowest on.
struct Progression {
  std::uintptr_t first;
  std::uintptr_t stride;
  std::uintptr_t bytes;  // of a value
  std::uintptr_t end;    // of the last value
};

template <class Value>
Progression progression(const Column<Value>& column, std::size_t size) {
  const auto one = reinterpret_cast<std::uintptr_t>(&column[0]);
  const auto other = reinterpret_cast<std::uintptr_t>(&column[size - 1]);
  const auto stride = static_cast<std::uintptr_t>(column.stride < 0 ? -column.stride : column.stride);
  return {std::min(one, other), stride * sizeof(Value), sizeof(Value), std::max(one, other) + sizeof(Value)};
}

bool apart(const Progression& a, const Progression& b) {
  if (a.end <= b.first || b.end <= a.first) return true;
  if (a.stride != b.stride || a.stride == 0) return false;
  // The place where b's values begin in a's periods.
  const std::uintptr_t beyond =
      b.first >= a.first ? (b.first - a.first) % a.stride : (a.stride - (a.first - b.first) % a.stride) % a.stride;
  return beyond >= a.bytes && beyond + b.bytes <= a.stride;
}

}  // namespace

void require_apart(const PointColumns& points, const ResultColumns& rows) {
  const std::size_t size = points.size();
  if (size == 0) return;
  const std::array results{progression(rows.lo(), size), progression(rows.hi(), size),
                           progression(rows.status(), size)};
  for (const Column<const double>& column : points.coordinates()) {
    const Progression coordinates = progression(column, size);
    if (!std::ranges::all_of(results, [&](const Progression& result) { return apart(coordinates, result); }))
      throw Error(ErrorKind::input, "the columns of the rows share memory with those of the coordinates");
  }
  if (!apart(results[0], results[1]) || !apart(results[0], results[2]) || !apart(results[1], results[2]))
    throw Error(ErrorKind::input, "the columns of the rows share memory with each other");
}

namespace {

static_assert(rows_per_block == device::rows_side_by_side);

double tightest_outside_of(const Model& model) {
  return verify::has_taper(model) ? tightest_outside_of_tapered : tightest_outside;
}

class PointProver {
 public:
  PointProver(const Model& model, const MapOptions& options)
      : model_(model),
        tolerance_(options.tolerance),
        certificates_(options.certificates),
        covers_(options.covers),
        published_(options.method == Method::published),
        stop_(either(options.interrupted, options.out_of_time)),
        radius_(bounding_radius(model)),
        tightest_outside_(tightest_outside_of(model)),
        distance_(model),
        witness_distance_(model) {
    if (published_ && (certificates_ || options.device != "host"))
      throw Error(ErrorKind::input, "the published method runs on the host alone and has no certificates");
    if (published_) verify::require_union_of_convex(model, "the published method");
    if (published_) verify::require_no_taper(model, "the published method");
    if (certificates_ && !covers_) verify::require_union(model, "certificates without covers");
    refuse_empty(model, distance_, options.interrupted);
    if (!options.out_of_time) return;
    if (certificates_) {
      late_rows_ = std::make_unique<LateRows>(model);
    } else {
      coarse_distance_ =
          std::make_unique<verify::CoarseDistance>(coarse_distance(model, distance_, options.interrupted));
    }
  }

  void check(const Point& p) const {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw Error(ErrorKind::input, fmt::format("point {} is not finite", describe(p)));
  }

  [[nodiscard]] std::string describe(const Point& p) const { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Point& point, const Enclosure& found) const {
    return verified(found, tightest_width(point, found, radius_, tightest_outside_));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Point& point) const {
    if (published_) return {published(point), {}};
    if (late_rows_) late_rows_->begin_anew();
    return certificates_ ? distance_.certified(point, tolerance_, stop_, covers_)
                         : CertifiedEnclosure{distance_(point, tolerance_, stop_), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Point& point) const {
    return certificates_ ? late_rows_->next(point) : CertifiedEnclosure{(*coarse_distance_)(point), {}};
  }

  [[nodiscard]] bool witnessed(const Point& point, double hi, const Certificate& certificate) const {
    return witness_distance_({point[0], point[1], point[2]}, certificate.normals.front()) <= hi;
  }

 private:
  // The published method knows points outside: the least of the primitives' distances where all are positive.
  [[nodiscard]] Enclosure published(const Point& point) const {
    Enclosure least = published_distance(model_.primitives.front(), point);
    for (const Primitive& primitive : model_.primitives) {
      const Enclosure other = published_distance(primitive, point);
      least = {std::min(least.lo, other.lo), std::min(least.hi, other.hi)};
    }
    return least.lo > 0.0 ? least : distance_(point, tolerance_, stop_);
  }

  Model model_;
  double tolerance_;
  bool certificates_;
  bool covers_;
  bool published_;
  std::function<bool()> stop_;
  double radius_;
  double tightest_outside_;
  SignedDistance distance_;
  verify::WitnessEstimate witness_distance_;
  std::unique_ptr<verify::CoarseDistance> coarse_distance_;  // without certificates, where there is a time limit
  std::unique_ptr<LateRows> late_rows_;                      // with certificates
};

/// A search may still narrow rows that are as tight as the device's proofs get; it gets their tolerance. With a
/// tolerance of 0 nothing tighter can be requested.
device::RowCriterion criterion(const MapOptions& options, double radius, bool searched, double outside) {
  const bool open_inside = searched && options.tolerance > 0.0;
  return {options.tolerance, open_inside ? -1.0 : tightest_inside * radius, outside, radius};
}

}  // namespace

std::unique_ptr<ExactMap<Point>> point_map(const Model& model, const MapOptions& options) {
  if (has_mesh(model)) return mesh_map(model, options);
  using Map = PreparedMap<Point, PointProver>;
  std::string unsuited = device::why_not_compiled(model);
  if (!is_union_of_convex(model)) {
    if (options.certificates) unsuited = "certificates of bent solids and set operations are the host's";
    const auto make_batch = [model, tolerance = options.tolerance](const device::Device& device) {
      return device::solid_batch(device, model, tolerance);
    };
    return std::make_unique<Map>(PointProver(model, options), options, model, make_batch, unsuited);
  }
  if (options.certificates) {
    const auto make_batch = [model, tolerance = options.tolerance](const device::Device& device) {
      return device::point_batch(device, model, tolerance, true);
    };
    return std::make_unique<Map>(PointProver(model, options), options, model, make_batch);
  }
  // If primitives overlap, the depth is not that of a single one: it takes a search over cubes, which has no
  // certificates.
  Map::MakeBatch make_search;
  const double radius = bounding_radius(model);
  if (model.primitives.size() > 1 && unsuited.empty()) {
    const double tolerance = std::max(options.tolerance, tightest_inside * radius);
    make_search = [model, tolerance](const device::Device& device) {
      return device::solid_batch(device, model, tolerance);
    };
  }
  return std::make_unique<PipedMap<PointProver>>(
      PointProver(model, options), options, model,
      criterion(options, radius, make_search != nullptr, tightest_outside_of(model)), make_search);
}

namespace {

// Maps of triangles.

/// Its corners.
std::string text_of(const Triangle& triangle) {
  std::string text;
  for (const Point& p : triangle) text += fmt::format("{}({}, {}, {})", text.empty() ? "" : " ", p[0], p[1], p[2]);
  return text;
}

/// Throws Error(input) for a triangle that is not finite.
void require_finite(const Triangle& triangle) {
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(triangle, [&](const Point& corner) { return std::ranges::all_of(corner, finite); }))
    throw Error(ErrorKind::input, fmt::format("triangle {} is not finite", text_of(triangle)));
}

/// As tight as searches get, where a tolerance of 0 asks for that.
double searched_tolerance(const MapOptions& options, double radius) {
  return std::max(options.tolerance, tightest_inside * radius);
}

class SolidTriangleProver {
 public:
  SolidTriangleProver(const Model& model, const MapOptions& options)
      : certificates_(options.certificates),
        radius_(bounding_radius(model)),
        tolerance_(searched_tolerance(options, radius_)),
        stop_(either(options.interrupted, options.out_of_time)),
        search_(model) {
    if (certificates_ && !options.covers && !has_mesh(model))
      verify::require_union_of_convex(model, "certificates without covers");
    const SignedDistance distance(model);
    refuse_empty(model, distance, options.interrupted);
    if (options.out_of_time) coarse_ = coarse_distance(model, distance, options.interrupted);
  }

  void check(const Triangle& triangle) const { require_finite(triangle); }
  [[nodiscard]] std::string describe(const Triangle& triangle) const { return text_of(triangle); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Triangle& triangle, const Enclosure& found) const {
    return verified(found, std::max(tightest_inside * radius_, tightest_width(triangle, found, radius_)));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Triangle& triangle) const {
    if (certificates_) return search_.certified(triangle, tolerance_, stop_);
    return {search_(triangle, tolerance_, stop_), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Triangle& triangle) const {
    if (certificates_) return {{0.0, infinity}, {}};  // nothing else has one
    const verify::DividedTriangle divided(triangle);
    const Enclosure at_corner = (*coarse_)(triangle[0]);
    const double lower = std::max(0.0, divided.lower_by_ball(triangle, triangle[0], at_corner.lo));
    return {{lower, divided.upper_by_point(at_corner.hi)}, {}};
  }

  [[nodiscard]] bool witnessed(const Triangle& /*triangle*/, double /*hi*/, const Certificate& /*none*/) const {
    return false;
  }

 private:
  bool certificates_;
  double radius_;
  double tolerance_;
  std::function<bool()> stop_;
  TriangleSearch search_;
  std::optional<verify::CoarseDistance> coarse_;  // where there is a time limit
};

/// As triangle_map, for models that are not is_union_of_convex. Throws Error(input) for a model that is proven to have
/// no point, and for options that ask for certificates without covers.
std::unique_ptr<ExactMap<Triangle>> solid_triangle_map(const Model& model, const MapOptions& options) {
  std::string unsuited = device::why_not_compiled(model);
  if (options.certificates) unsuited = "certificates of bent solids and set operations are the host's";
  const auto make_batch = [model, options](const device::Device& device) {
    const double tolerance = searched_tolerance(options, bounding_radius(model));
    return device::solid_triangle_batch(device, model, tolerance, either(options.interrupted, options.out_of_time));
  };
  return std::make_unique<PreparedMap<Triangle, SolidTriangleProver>>(SolidTriangleProver(model, options), options,
                                                                      model, make_batch, unsuited);
}

class TriangleProver {
 public:
  TriangleProver(const Model& model, const MapOptions& options)
      : certificates_(options.certificates),
        radius_(bounding_radius(model)),
        distance_(model),
        late_rows_(std::make_unique<LateRows>(model)),
        witness_distance_(model) {}

  void check(const Triangle& triangle) const { require_finite(triangle); }
  [[nodiscard]] std::string describe(const Triangle& triangle) const { return text_of(triangle); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Triangle& triangle, const Enclosure& found) const {
    return verified(found, tightest_width(triangle, found, radius_));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Triangle& triangle) const {
    late_rows_->begin_anew();
    return certificates_ ? distance_.certified(triangle) : CertifiedEnclosure{distance_(triangle), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Triangle& triangle) const { return late_rows_->next(triangle); }

  [[nodiscard]] bool witnessed(const Triangle& triangle, double hi, const Certificate& certificate) const {
    if (!certificate.weights) return false;
    const auto [w1, w2] = *certificate.weights;
    std::array<long double, 3> q{};
    for (std::size_t i = 0; i < 3; ++i) {
      const long double corner = triangle[0][i];
      q[i] = corner + w1 * (triangle[1][i] - corner) + w2 * (triangle[2][i] - corner);
    }
    return witness_distance_(q, certificate.normals.front()) <= hi;
  }

 private:
  bool certificates_;
  double radius_;
  TriangleDistance distance_;
  std::unique_ptr<LateRows> late_rows_;
  verify::WitnessEstimate witness_distance_;
};

std::unique_ptr<ExactMap<Triangle>> triangle_map(const Model& model, const MapOptions& options) {
  if (options.method == Method::published) throw Error(ErrorKind::input, "the published method maps points alone");
  if (!is_union_of_convex(model)) return solid_triangle_map(model, options);
  const auto make_batch = [model, certificates = options.certificates](const device::Device& device) {
    return device::triangle_batch(device, model, certificates);
  };
  return std::make_unique<PreparedMap<Triangle, TriangleProver>>(
      TriangleProver(model, options), options, model, make_batch, device::why_not_as_triangles_or_pairs(model));
}

using verify::MemberBounds;

/// The obligation of Bracket: where the primitives of a union move independently of each other, no upper end may be
/// proven by several of them together. Certificates never are.
MapOptions by_single_primitives(const Bracket& models, MapOptions options) {
  if (models.inflated) {
    options.certificates = true;
    options.covers = false;
    options.method = Method::duality;  // the published one has none
  }
  return options;
}

template <class Query>
BracketedMap<Query> maps_of(const Bracket& models, const MapOptions& options);

template <>
BracketedMap<Point> maps_of(const Bracket& models, const MapOptions& options) {
  const auto for_upper_ends = [&](const Model& model) {
    return point_map(model, by_single_primitives(models, options));
  };
  return verify::bracketed(models, for_upper_ends, [&](const Model& model) { return point_map(model, options); });
}

/// Only signed distances need the inflated model, for points deep in a union (see Bracket).
template <>
BracketedMap<Triangle> maps_of(const Bracket& models, const MapOptions& options) {
  Bracket without_inflated = models;
  without_inflated.inflated.reset();
  return verify::bracketed(without_inflated, [&](const Model& model) { return triangle_map(model, options); });
}

template <class Query>
BracketMap<Query> bracket_map_of(const Bracket& models, const MapOptions& options) {
  refuse_empty_members(models, options.interrupted);
  const MemberBounds bounds(models, options.point_radius);
  return {bounds, options, maps_of<Query>(models, of_one_end(bounds, options))};
}

/// Of points, where the model is one that convexity says more of.
template <class Query>
std::optional<ConvexPoseRows> convex_rows_of(const Bracket& models, const MapOptions& options, double reach) {
  if (!std::same_as<Query, Point> || !options.pose_uncertainty) return std::nullopt;
  if (!MemberBounds(models, 0.0).exact() || !is_union_of_convex(models.largest)) return std::nullopt;
  return ConvexPoseRows(models.largest, *options.pose_uncertainty, at_nominal_pose(options, reach));
}

}  // namespace

template <class Query>
UncertainPoseMap<Query> map_of(const Bracket& models, const MapOptions& options) {
  check_uncertain_pose(options, std::same_as<Query, Point>);
  const double reach = reach_of(options, models.largest);
  return {options, reach, bracket_map_of<Query>(models, at_nominal_pose(options, reach)),
          convex_rows_of<Query>(models, options, reach)};
}

template class Mapper<Point>;
template class Mapper<Triangle>;

}  // namespace verisq
