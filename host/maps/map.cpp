/// Tests whether rows of a map would be written where its queries, or other rows, lie.
#include "verisq/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "host/device/device_model.hpp"
#include "host/device/query_batches.hpp"
#include "host/device/solid_batch.hpp"
#include "host/device/solid_model.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/piped_map.hpp"
#include "host/maps/uncertain_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/fit_box_bound.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/model.hpp"
#include "verisq/device.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"

namespace verisq {

/// Throws Error(input) if a value of a row may share memory with a coordinate or with another value of a row: rows are
/// written while coordinates are read. Columns that interleave, like those of one record, lie apart if their strides
/// are equal. Precondition: as many rows as points.
void require_apart(const PointColumns& points, const ResultColumns& rows);

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

using verify::MemberBounds;

/// The options of the bracketing models' maps: each end to half the tolerance.
MapOptions of_one_end(const MemberBounds& bounds, MapOptions options) {
  if (bounds.exact()) return options;
  options.tolerance = options.tolerance / 2;
  options.covers = false;  // by several primitives together
  return options;
}

/// The obligation of Bracket: if the primitives of a union move independently of each other, no upper end may be proven
/// by several of them together. Certificates never do that.
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

BracketedMap<Pose> maps_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  BracketedMap<Pose> maps{pose_map(a.smallest, b.smallest, options), std::nullopt, std::nullopt};
  if (!verify::same_solids(a) || !verify::same_solids(b)) maps.largest = pose_map(a.largest, b.largest, options);
  return maps;
}

template <class Query>
BracketMap<Query> bracket_map_of(const Bracket& models, const MapOptions& options) {
  refuse_empty_members(models, options.interrupted);
  const MemberBounds bounds(models, options.point_radius);
  return {bounds, options, maps_of<Query>(models, of_one_end(bounds, options))};
}

BracketMap<Pose> bracket_map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  for (const Bracket* models : {&a, &b}) refuse_empty_members(*models, options.interrupted);
  const MemberBounds bounds(a, b);
  return {bounds, options, maps_of(a, b, of_one_end(bounds, options))};
}

/// An infinite tolerance takes any enclosure.
void check_lengths(const MapOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* what) {
    if (!holds) throw Error(ErrorKind::input, fmt::format("map: {} = {}: must be {}", name, value, what));
  };
  require(options.tolerance >= 0.0, "tolerance", options.tolerance, "at least 0");
  require(options.point_radius >= 0.0 && std::isfinite(options.point_radius), "point_radius", options.point_radius,
          "finite and at least 0");
}

void check_uncertain_pose(const MapOptions& options, bool divisible) {
  check_lengths(options);
  if (!options.pose_uncertainty) return;
  const auto refuse = [](const char* what) { throw Error(ErrorKind::input, fmt::format("uncertain poses: {}", what)); };
  if (options.certificates) refuse("there are no certificates");
  if (options.tolerance == 0.0) refuse("rows are never narrower than distances differ: the tolerance must be above 0");
  if (options.pose_divisions == 0) refuse("the divisions must be at least 1");
  if (options.pose_divisions > 1 && !divisible) refuse("places are divided for points alone");
}

/// The options at the nominal pose: distances to a small part of the remaining change by the motions, which move the
/// model by at most `reach`.
MapOptions at_nominal_pose(MapOptions options, double reach) {
  constexpr double parts = 32.0;
  if (options.pose_uncertainty)
    options.tolerance = std::max(options.tolerance, reach) / (parts * options.pose_divisions);
  return options;
}

double reach_of(const MapOptions& options, const Model& model) {
  return options.pose_uncertainty ? verify::reach_of(*options.pose_uncertainty, model) : 0.0;
}

/// For points, if convexity says more about the model.
template <class Query>
std::optional<ConvexPoseRows> convex_rows_of(const Bracket& models, const MapOptions& options, double reach) {
  if (!std::same_as<Query, Point> || !options.pose_uncertainty) return std::nullopt;
  if (!MemberBounds(models, 0.0).exact() || !is_union_of_convex(models.largest)) return std::nullopt;
  return ConvexPoseRows(models.largest, *options.pose_uncertainty, at_nominal_pose(options, reach));
}

template <class Query>
UncertainPoseMap<Query> map_of(const Bracket& models, const MapOptions& options) {
  check_uncertain_pose(options, std::same_as<Query, Point>);
  const double reach = reach_of(options, models.largest);
  return {options, reach, bracket_map_of<Query>(models, at_nominal_pose(options, reach)),
          convex_rows_of<Query>(models, options, reach)};
}

UncertainPoseMap<Pose> map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  check_uncertain_pose(options, false);
  const double reach = reach_of(options, b.largest);
  return {options, reach, bracket_map_of(a, b, at_nominal_pose(options, reach))};
}

}  // namespace

template <class Query>
struct Mapper<Query>::State {
  /// Threads that prove rows see the answers of the caller's thread.
  template <class... Models>
  State(const MapOptions& options, const Models&... models)
      : interrupted(std::make_shared<SeenInterruption>(options.interrupted)), map(made(options, models...)) {}

  std::shared_ptr<SeenInterruption> interrupted;
  UncertainPoseMap<Query> map;

 private:
  template <class... Models>
  [[nodiscard]] UncertainPoseMap<Query> made(MapOptions options, const Models&... models) const {
    options.interrupted = [seen = interrupted] { return (*seen)(); };
    if constexpr (sizeof...(Models) == 2) {
      return map_of(models..., options);
    } else {
      return map_of<Query>(models..., options);
    }
  }
};

// clang 14 instantiates constructors whose constraints do not hold, too.
template <class Query>
Mapper<Query>::Mapper(const UncertainModel& model, const MapOptions& options) requires(!std::same_as<Query, Pose>) {
  if constexpr (!std::same_as<Query, Pose>) state_.reset(new State(options, bracket(model)));
}

template <class Query>
Mapper<Query>::Mapper(const UncertainModel& a, const UncertainModel& b,
                      const MapOptions& options) requires std::same_as<Query, Pose> {
  if constexpr (std::same_as<Query, Pose>) state_.reset(new State(options, bracket(a), bracket(b)));
}

template <class Query>
Mapper<Query>::~Mapper() = default;
template <class Query>
Mapper<Query>::Mapper(Mapper&&) noexcept = default;
template <class Query>
Mapper<Query>& Mapper<Query>::operator=(Mapper&&) noexcept = default;

template <class Query>
MapSummary Mapper<Query>::map(const Source<Query>& source, const Sink<Query>& sink) {
  state_->interrupted->begin_anew();
  return state_->map.map(source, sink);
}

template <class Query>
MapSummary Mapper<Query>::map(const Queries& queries, const ResultColumns& rows) {
  if (rows.size() != queries.size())
    throw Error(ErrorKind::input,
                fmt::format("there is memory for {} rows, not for those of {} queries", rows.size(), queries.size()));
  if (state_->map.options().certificates)
    throw Error(ErrorKind::input, "certificates need a sink: columns of rows have no place for them");
  if constexpr (std::same_as<Query, Point>) require_apart(queries, rows);
  state_->interrupted->begin_anew();
  return state_->map.map_in_memory(queries, rows);
}

template class Mapper<Point>;
template class Mapper<Triangle>;
template class Mapper<Pose>;

}  // namespace verisq
