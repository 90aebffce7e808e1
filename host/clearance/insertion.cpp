/// Branch and bound in time: every point's way through the implant's frame is sampled by the map, and halved where the
/// bounds between two samples leave the minimum open.
///
/// The distance to a solid changes by no more than the point moves (it is 1-Lipschitz, inside too). So with T the pose,
/// sd(T solid, c) = sd(solid, T^-1 c): one map of the resting implant serves all poses, of the midpoints of the balls
/// that hold the exact points, each row widened by the ball's radius; and on a way of length L between samples with
/// lower ends lo_a and lo_b every distance is at least max(lo_a - l, lo_b - (L - l)) >= (lo_a + lo_b - L) / 2.
#include "verisq/insertion.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/maps/summary_count.hpp"
#include "host/mesh/extent.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/placement/middle_of_way.hpp"
#include "verify/placement/path_check.hpp"
#include "verify/placement/rigid_path.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using verify::Direction;
using verify::RigidPath;

/// Of the tolerance goes to the samples at placements, the rest to the ways between them. Wider samples cost less each,
/// but more of them are needed.
constexpr double share_of_placements = 0.25;
/// Of a point: beyond them its enclosure stays as wide as it is.
constexpr std::size_t most_samples = std::size_t{1} << 13U;
/// Searched at a time: enough to keep a device busy, few enough to fit into memory with all their samples.
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

/// What is known of one point.
struct PointSearch {
  Point point;
  std::vector<Stretch> open = {};
  double settled_lo = -infinity;  ///< of all of the path that is in no open stretch
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

/// A distance asked for: of a point at a time, to halve one of its stretches.
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

  /// The stretches that may hold a smaller distance than all samples by more than the tolerance; the others are
  /// settled: the smallest distance known will only fall.
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
    // What is left then is the width of the samples, which may be the tightest there are.
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
      // What was known of the whole holds for its parts.
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
  check_path(path);
  state_ = std::make_unique<State>(path, implant, bone, options);
}

InsertionMapper::~InsertionMapper() = default;
InsertionMapper::InsertionMapper(InsertionMapper&&) noexcept = default;
InsertionMapper& InsertionMapper::operator=(InsertionMapper&&) noexcept = default;

Insertion InsertionMapper::operator()(std::size_t first, std::size_t count) {
  return state_->search(state_->bone.subspan(first, count));
}

Insertion smallest_distance_along(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                                  const InsertionOptions& options) {
  return InsertionMapper(path, implant, bone, options)(0, bone.size());
}

}  // namespace verisq
