/// Ways of an implant into the bone: distances along them, and the one that takes the least bone away.
#include "verisq/insertion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "host/errors/refusal.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using verify::Direction;
using verify::RigidPath;

/// Share of the tolerance for the samples at placements; the rest is for the ways between them. Wider samples cost less
/// each, but more of them are needed.
constexpr double share_of_placements = 0.25;
/// Limit for one point: beyond it the point's enclosure stays as wide as it is.
constexpr std::size_t most_samples = std::size_t{1} << 13U;
/// The number of points searched at a time: enough to keep a device busy, few enough to fit into memory with all their
/// samples.
constexpr std::size_t chunk_size = points_per_insertion_block;

struct Sample {
  double time;
  Enclosure distance;
};

/// A part of the path between two samples.
struct Stretch {
  Sample begin;
  Sample end;
  double length;  ///< of the point's way, rounded up
  double bound;   ///< no distance on it is less
};

/// The search for one point.
struct PointSearch {
  Point point;
  std::vector<Stretch> open = {};
  double settled_lo = -infinity;  ///< least distance on the part of the path that is in no open stretch
  double hi = infinity;
  double deepest = 0.0;  ///< the time of that end
  std::size_t samples = 0;
  bool host_worked = false;

  [[nodiscard]] Enclosure distance() const {
    double lo = settled_lo;
    for (const Stretch& stretch : open) lo = std::min(lo, stretch.bound);
    return verify::between(lo, hi, [&] { return "the smallest distance on the way of " + verify::text_of(point); });
  }
};

/// A requested distance: of a point at a time, to halve one of its stretches.
struct Query {
  std::size_t search;
  std::size_t stretch;
  double time;
};

double least_distance(double lo_a, double lo_b, double length) {
  const double sum = verify::add(lo_a, lo_b, Direction::down);
  return verify::multiply(0.5, verify::subtract(sum, length, Direction::down), Direction::down);
}

class PathSearch {
 public:
  PathSearch(const RigidPath& path, const Model& implant, const InsertionOptions& options)
      : path_(path), options_(options), mapper_(implant, map_options(path, options)) {}

  Insertion operator()(std::span<const Point> bone) {
    insertion_ = {};
    summary_ = empty_summary();
    for (std::size_t first = 0; first < bone.size(); first += chunk_size) {
      search(bone.subspan(first, std::min(chunk_size, bone.size() - first)), bone.size());
    }
    insertion_.summary = summary_;
    return std::move(insertion_);
  }

 private:
  static MapOptions map_options(const RigidPath& path, const InsertionOptions& options) {
    const double share = path.last_time() == 0.0 ? 1.0 : share_of_placements;
    return {.tolerance = share * options.tolerance, .device = options.device, .interrupted = options.interrupted};
  }

  void search(std::span<const Point> points, std::size_t all_points) {
    searches_.clear();
    poses_.clear();
    for (const Point& point : points) searches_.push_back({.point = point});
    if (!summary_.interrupted) sample_ends();
    while (!summary_.interrupted) {
      const std::vector<Query> queries = halvings();
      const auto finished = static_cast<std::size_t>(
          std::ranges::count_if(searches_, [](const PointSearch& search) { return search.open.empty(); }));
      options_.progress(static_cast<double>(insertion_.rows.size() + finished) / static_cast<double>(all_points));
      if (queries.empty()) break;
      halve(queries);
    }
    for (const PointSearch& search : searches_) deliver(search);
  }

  void sample_ends() {
    const double last = path_.last_time();
    std::vector<Query> queries;
    for (std::size_t n = 0; n < searches_.size(); ++n) {
      queries.push_back({n, 0, 0.0});
      if (last > 0.0) queries.push_back({n, 0, last});
    }
    std::vector<Sample> samples = sample(queries);
    const std::size_t each = last > 0.0 ? 2 : 1;
    for (std::size_t n = 0; each * n + each <= samples.size(); ++n) {
      PointSearch& search = searches_[n];
      search.settled_lo = infinity;
      if (last > 0.0) {
        search.open.push_back(stretch(search.point, samples[2 * n], samples[2 * n + 1]));
      } else {
        search.settled_lo = samples[n].distance.lo;
      }
    }
  }

  /// The stretches that may contain a smaller distance than all samples by more than the tolerance. The others are
  /// settled: the smallest known distance can only fall.
  std::vector<Query> halvings() {
    std::vector<Query> queries;
    for (std::size_t n = 0; n < searches_.size(); ++n) {
      PointSearch& search = searches_[n];
      std::erase_if(search.open, [&](const Stretch& stretch) {
        if (can_narrow(search, stretch)) return false;
        search.settled_lo = std::min(search.settled_lo, stretch.bound);
        return true;
      });
      for (std::size_t i = 0; i < search.open.size(); ++i)
        queries.push_back({n, i, verify::middle_of_way(search.open[i].begin.time, search.open[i].end.time)});
    }
    return queries;
  }

  [[nodiscard]] bool can_narrow(const PointSearch& search, const Stretch& stretch) const {
    if (stretch.bound >= search.hi) return false;
    if (search.hi - stretch.bound <= options_.tolerance) return false;
    // The remaining width is the width of the samples, which may be the tightest possible.
    const double widest = std::max(stretch.begin.distance.width(), stretch.end.distance.width());
    if (stretch.length <= std::max(widest, share_of_placements * options_.tolerance)) return false;
    const double half = verify::middle_of_way(stretch.begin.time, stretch.end.time);
    return search.samples < most_samples && stretch.begin.time < half && half < stretch.end.time;
  }

  void halve(const std::vector<Query>& queries) {
    const std::vector<Sample> samples = sample(queries);
    for (std::size_t n = 0; n < samples.size(); ++n) {
      PointSearch& search = searches_[queries[n].search];
      const Stretch whole = search.open[queries[n].stretch];
      Stretch first = stretch(search.point, whole.begin, samples[n]);
      Stretch second = stretch(search.point, samples[n], whole.end);
      // The bound of the whole is valid for its parts.
      first.bound = std::max(first.bound, whole.bound);
      second.bound = std::max(second.bound, whole.bound);
      search.open[queries[n].stretch] = first;
      search.open.push_back(second);  // after those that queries point at
    }
  }

  [[nodiscard]] Stretch stretch(const Point& point, const Sample& begin, const Sample& end) const {
    const double length = path_.length_up(point, begin.time, end.time);
    return {begin, end, length, least_distance(begin.distance.lo, end.distance.lo, length)};
  }

  /// Fewer than the queries, their first ones, when the map was interrupted. Upper ends go to the searches.
  std::vector<Sample> sample(const std::vector<Query>& queries) {
    std::vector<double> radii(queries.size());
    std::vector<Sample> samples;
    std::size_t asked = 0;
    const Source<Point> source = [&](std::span<Point> points) {
      const std::size_t count = std::min(points.size(), queries.size() - asked);
      for (std::size_t i = 0; i < count; ++i, ++asked) {
        const auto [centre, radius] =
            RigidPath::local_point(nearest_pose(queries[asked].time), searches_[queries[asked].search].point);
        points[i] = centre;
        radii[asked] = radius;
      }
      return count;
    };
    const Sink<Point> sink = [&](std::span<const Point>, std::span<const MapResult> rows,
                                 std::span<const Certificate>) {
      for (const MapResult& row : rows) {
        const Query& query = queries[samples.size()];
        const double radius = radii[samples.size()];
        PointSearch& search = searches_[query.search];
        const Enclosure distance{verify::subtract(row.distance.lo, radius, Direction::down),
                                 verify::add(row.distance.hi, radius, Direction::up)};
        samples.push_back({query.time, distance});
        if (distance.hi < search.hi) search.deepest = query.time;
        search.hi = std::min(search.hi, distance.hi);
        search.host_worked = search.host_worked || row.status != Status::device_verified;
        ++search.samples;
      }
    };
    const MapSummary map = mapper_.map(source, sink);
    summary_.device = map.device;
    summary_.notice = map.notice;
    summary_.device_seconds += map.device_seconds;
    summary_.host_seconds += map.host_seconds;
    summary_.interrupted = summary_.interrupted || map.interrupted;
    return samples;
  }

  const RigidPath::NearestPose& nearest_pose(double time) {
    const auto known = poses_.find(time);
    return known != poses_.end() ? known->second : poses_.emplace(time, path_.nearest_pose(time)).first->second;
  }

  void deliver(const PointSearch& search) {
    const Enclosure distance = search.distance();
    const Status status = !verified(distance, options_.tolerance) ? Status::wide
                          : search.host_worked                    ? Status::host_verified
                                                                  : Status::device_verified;
    insertion_.rows.push_back({distance, status});
    insertion_.deepest.push_back(search.deepest);
    count(summary_, insertion_.rows.back());
  }

  const RigidPath& path_;
  const InsertionOptions& options_;
  PointMapper mapper_;
  std::vector<PointSearch> searches_;
  std::map<double, RigidPath::NearestPose> poses_;
  MapSummary summary_ = empty_summary();
  Insertion insertion_{};
};

using SearchOfPoints = std::function<Insertion(std::span<const Point>)>;

/// `path` and `options` must outlive it.
SearchOfPoints search_along(const RigidPath& path, const Model& implant, const InsertionOptions& options) {
  const auto search = std::make_shared<PathSearch>(path, implant, options);
  return [search](std::span<const Point> points) { return (*search)(points); };
}

}  // namespace

std::vector<Pose> straight_path(const Pose& last, const Point& direction, double length, std::size_t steps) {
  // Neither overflows nor underflows: first to a largest coordinate of 1.
  const double largest = std::max({std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2])});
  const Point unscaled{direction[0] / largest, direction[1] / largest, direction[2] / largest};
  const double size = std::hypot(unscaled[0], unscaled[1], unscaled[2]);
  std::vector<Pose> path(steps + 1, last);
  for (std::size_t k = 0; k < steps; ++k) {
    const double before = length * (static_cast<double>(steps - k) / static_cast<double>(steps));
    for (std::size_t i = 0; i < 3; ++i) path[k].translation[i] -= before * (unscaled[i] / size);
  }
  return path;
}

struct InsertionMapper::State {
  State(std::span<const Pose> path, const Model& implant, std::span<const Point> all, const InsertionOptions& given)
      : options(given), way(path, extent_of(all).centre()), search(search_along(way, implant, options)), bone(all) {}

  InsertionOptions options;
  RigidPath way;
  SearchOfPoints search;
  std::span<const Point> bone;
};

InsertionMapper::InsertionMapper(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                                 const InsertionOptions& options) {
  verify::require_valid_with_meshes(implant);
  check_path(path);
  state_ = hidden<State>(path, implant, bone, options);
}

Insertion InsertionMapper::operator()(std::size_t first, std::size_t count) {
  return state_->search(state_->bone.subspan(first, count));
}

Insertion smallest_distance_along(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                                  const InsertionOptions& options) {
  return InsertionMapper(path, implant, bone, options)(0, bone.size());
}

namespace {

constexpr double degree_of_turn = std::numbers::pi / 180.0;
/// Between two poses translations are linear. So a point off the axis by r leaves its circle by r a²/8, at most 4e-5 r
/// for turns a of so many degrees.
constexpr double degrees_of_a_step = 1.0;
constexpr double most_degrees = 360.0;

void check_way(const WayIn& way, const Point& centre) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(way.direction, finite) || way.direction == Point{})
    refuse("way in: its direction is not finite, or zero");
  if (!(std::isfinite(way.length) && way.length > 0.0))
    refuse(fmt::format("way in: length {} is not a number above 0", way.length));
  if (!(std::abs(way.turn_degrees) <= most_degrees))
    refuse(fmt::format("way in: a turn by {} degrees is beyond {}", way.turn_degrees, most_degrees));
  if (!std::ranges::all_of(centre, finite)) refuse("way in: the centre of its turn is not finite");
}

}  // namespace

Point turning_centre(const Model& implant) {
  verify::require_valid_with_meshes(implant);
  const verify::Box box = verify::bounding_box(implant);
  return point_of((vector_of(box.lower) + vector_of(box.upper)) / 2.0);
}

std::vector<Pose> path_of(const WayIn& way, const Point& centre) {
  check_way(way, centre);
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(std::abs(way.turn_degrees) / degrees_of_a_step)));
  std::vector<Pose> path = straight_path({}, way.direction, way.length, steps);
  if (way.turn_degrees == 0.0) return path;
  const Eigen::Vector3d axis = vector_of(verify::near_one(way.direction)).stableNormalized();
  for (std::size_t k = 0; k < steps; ++k) {  // the last one is as the implant's file has it
    const double left = static_cast<double>(steps - k) / static_cast<double>(steps);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(-left * way.turn_degrees * degree_of_turn, axis));
    const Eigen::Vector3d moved = vector_of(path[k].translation) + vector_of(centre) - turn * vector_of(centre);
    path[k] = {point_of(moved), {turn.w(), turn.x(), turn.y(), turn.z()}};
  }
  return path;
}

namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double widest_cone = 80.0;
constexpr double largest_turn = 180.0;
constexpr double largest_turn_of_way = 360.0;

/// Ways of each round, the middle one besides.
constexpr std::array<std::size_t, 4> ways_of_rounds{15, 12, 12, 12};
/// Factor of cone and turn from one round to the next.
constexpr double shrinking = 0.4;

/// Limit of the cubes for a compared way: for turning ways more would cost minutes each.
constexpr std::uint64_t most_cubes_compared = std::uint64_t{1} << 16U;

/// The constant of a low-discrepancy sequence in three dimensions: powers of the root of x⁴ = x + 1 (M. Roberts, "The
/// unreasonable effectiveness of quasirandom sequences", 2018).
constexpr double generalised_golden_ratio = 1.2207440846057596;

double fraction(double x) {
  return x - std::floor(x);
}

void check_family(const WaysIn& ways) {
  if (!(ways.cone_degrees >= 0.0 && ways.cone_degrees <= widest_cone))
    refuse(fmt::format("ways in: a cone of {} degrees is not between 0 and {}", ways.cone_degrees, widest_cone));
  if (!(ways.turn_degrees >= 0.0 && ways.turn_degrees <= largest_turn))
    refuse(fmt::format("ways in: turns by {} degrees are not between 0 and {}", ways.turn_degrees, largest_turn));
  const double farthest = std::abs(ways.middle.turn_degrees) + ways.turn_degrees;
  if (!(farthest <= largest_turn_of_way))
    refuse(fmt::format("ways in: turns by up to {} degrees are beyond {}", farthest, largest_turn_of_way));
  if (ways.cone_degrees == 0.0 && ways.turn_degrees == 0.0)
    refuse("ways in: with neither a cone nor turns there is one way");
}

/// Off the axis by `angle`, in the direction of `azimuth` about it.
Eigen::Vector3d tilted(const Eigen::Vector3d& axis, double angle, double azimuth) {
  const Eigen::Vector3d across = axis.unitOrthogonal();
  const Eigen::Vector3d other = axis.cross(across);
  return std::cos(angle) * axis + std::sin(angle) * (std::cos(azimuth) * across + std::sin(azimuth) * other);
}

/// The direction, or the nearest one that is off the axis by no more than `angle`.
Eigen::Vector3d within_cone(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d off_axis = direction - direction.dot(axis) * axis;
  if (std::atan2(off_axis.norm(), direction.dot(axis)) <= angle || !(off_axis.norm() > 0.0)) return direction;
  return std::cos(angle) * axis + std::sin(angle) * off_axis.normalized();
}

class WaySearch {
 public:
  WaySearch(const WaysIn& ways, const Point& centre, const Model& implant, const BoneRegion& bone,
            const LeastRemovalOptions& options)
      : ways_(ways),
        axis_(vector_of(verify::near_one(ways.middle.direction)).stableNormalized()),
        centre_(centre),
        implant_(implant),
        bone_(bone),
        options_(options) {}

  LeastRemoval operator()() {
    LeastRemoval found{};
    found.of_middle = consider(ways_.middle);
    double share = 1.0;
    for (const std::size_t ways : ways_of_rounds) {
      const WayIn about = best_;
      for (std::size_t k = 0; k < ways && !options_.volume.interrupted(); ++k) consider(way_about(about, share));
      share *= shrinking;
    }
    found.way = best_;
    found.path = path_of(best_, centre_);
    found.removed = removed_volume(found.path, implant_, bone_, options_.volume);
    found.tried = volumes_.size();
    found.worse = static_cast<std::size_t>(
        std::ranges::count_if(volumes_, [&](const Enclosure& volume) { return volume.lo > found.removed.volume.hi; }));
    found.interrupted = options_.volume.interrupted();
    return found;
  }

 private:
  /// The next one of the sequence, in a share of the family about this way.
  WayIn way_about(const WayIn& about, double share) {
    ++drawn_;
    const auto n = static_cast<double>(drawn_);
    const double radius = fraction(0.5 + n / generalised_golden_ratio);
    const double azimuth = fraction(0.5 + n / std::pow(generalised_golden_ratio, 2));
    const double turn = fraction(0.5 + n / std::pow(generalised_golden_ratio, 3));
    const double cone = ways_.cone_degrees * degree;
    // Evenly over the cap: its area within an angle grows with the angle's square, nearly.
    const Eigen::Vector3d drawn = tilted(vector_of(verify::near_one(about.direction)).stableNormalized(),
                                         share * cone * std::sqrt(radius), 2.0 * std::numbers::pi * azimuth);
    WayIn way = about;
    if (ways_.cone_degrees > 0.0) way.direction = point_of(within_cone(axis_, cone, drawn));
    const double middle = ways_.middle.turn_degrees;
    way.turn_degrees = std::clamp(about.turn_degrees + share * ways_.turn_degrees * (2.0 * turn - 1.0),
                                  middle - ways_.turn_degrees, middle + ways_.turn_degrees);
    return way;
  }

  /// The volume that the way takes away, or a lower bound that exceeds the best way's.
  Enclosure consider(const WayIn& way) {
    RemovedVolumeOptions options = options_.volume;
    options.relative_tolerance = std::max(options.relative_tolerance, options_.relative_tolerance);
    options.most_cubes = std::min(options.most_cubes, most_cubes_compared);
    double known = 0.0;
    options.progress = [&known](const Enclosure& volume) { known = volume.lo; };
    options.interrupted = [&] { return known > least_.hi || options_.volume.interrupted(); };
    const Enclosure volume = removed_volume(path_of(way, centre_), implant_, bone_, options).volume;
    if (volumes_.empty() || volume.hi < least_.hi) {
      least_ = volume;
      best_ = way;
    }
    volumes_.push_back(volume);
    options_.progress({volumes_.size(), all_ways(), least_});
    return volume;
  }

  static std::size_t all_ways() {
    std::size_t ways = 1;
    for (const std::size_t more : ways_of_rounds) ways += more;
    return ways;
  }

  const WaysIn& ways_;
  Eigen::Vector3d axis_;
  Point centre_;
  const Model& implant_;
  const BoneRegion& bone_;
  const LeastRemovalOptions& options_;
  std::size_t drawn_ = 0;
  WayIn best_{};
  Enclosure least_{0.0, infinity};
  std::vector<Enclosure> volumes_;
};

}  // namespace

LeastRemoval least_removal(const WaysIn& ways, const Point& centre, const Model& implant, const BoneRegion& bone,
                           const LeastRemovalOptions& options) {
  verify::require_valid(implant);
  check_family(ways);
  static_cast<void>(path_of(ways.middle, centre));  // refuses what is no way
  return WaySearch(ways, centre, implant, bone, options)();
}

}  // namespace verisq
