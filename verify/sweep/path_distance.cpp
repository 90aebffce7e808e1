/// Halves the stretches of time in which the smallest distance, or the first contact, may be.
#include "verisq/path_distance.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>
#include <verisq/error.hpp>

#include "verify/placement/path_check.hpp"
#include "verify/placement/rigid_path.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/pair_contact.hpp"
#include "verify/sweep/moving_pairs.hpp"

namespace verisq {

using namespace verify;

namespace {

/// Of one leg; both ends are exact binary64 numbers, as is the middle of what may still be halved.
struct Stretch {
  std::size_t leg;
  double begin, end;         ///< times of the path
  double lower = -infinity;  ///< of the distance, at all its times
};

/// What was found at the middle of a stretch.
struct Moment {
  double time;
  double lower;  ///< over the stretch
  double upper;  ///< at the middle; 0 where a common point is proven
};

double middle_of(const Stretch& stretch) {
  return 0.5 * (stretch.begin + stretch.end);  // exact: both are multiples of `shortest`, which has a half
}

/// Two models and the path between them.
class Motion {
 public:
  Motion(std::span<const Pose> poses, const Model& a, const Model& b)
      : poses_(poses), path_(poses), a_(a), b_(b), shortest_(std::fmax(0x1p-40, std::ldexp(path_.last_time(), -50))) {}

  [[nodiscard]] double last_time() const { return path_.last_time(); }

  [[nodiscard]] std::vector<Stretch> legs() const {
    std::vector<Stretch> legs;
    for (std::size_t k = 0; k + 1 < poses_.size(); ++k)
      legs.push_back({k, static_cast<double>(k), static_cast<double>(k + 1)});
    if (legs.empty()) legs.push_back({0, 0.0, 0.0});
    return legs;
  }

  /// The largest length at hand.
  [[nodiscard]] double size() const {
    double size = 0.0;
    for (const PosedPrimitives* model : {&a_, &b_}) {
      for (std::size_t i = 0; i < model->primitives.size(); ++i) {
        const PreciseInterval reach = length<Real>(model->motions[i].translation) + model->primitives[i].radius();
        size = std::max(size, reach.upper().to_double(Direction::up));
      }
    }
    for (const Pose& pose : poses_) {
      for (const double t : pose.translation) size = std::max(size, std::abs(t));
    }
    return size;
  }

  [[nodiscard]] bool may_be_halved(const Stretch& stretch) const { return stretch.end - stretch.begin > shortest_; }

  /// Pairs whose distance is proven to be more than `enough` by their spheres are not looked at closer.
  [[nodiscard]] Moment examine(const Stretch& stretch, double enough) const {
    const double time = middle_of(stretch);
    const double reach = 0.5 * (stretch.end - stretch.begin);
    const MovingPairs moving(a_, b_, path_.enclosed_pose(time), motion_of(stretch.leg));
    const PosedPairs& pairs = moving.pairs();
    Moment moment{time, infinity, infinity};
    const auto by_spheres = [&](std::size_t k) {
      return moving.lower_by_spheres(k / pairs.size_b(), k % pairs.size_b(), reach);
    };
    for (const auto& [bound, k] : nearest_spheres_first(pairs.size_a() * pairs.size_b(), by_spheres)) {
      if (bound > enough || bound > moment.upper) {
        moment.lower = std::min(moment.lower, bound);
        break;
      }
      const std::size_t i = k / pairs.size_b();
      const std::size_t j = k % pairs.size_b();
      const PairBounds at_moment = pairs(i, j);
      const PairContact contact =
          fast_pair_contact(at_moment.a().superquadric(), at_moment.b().superquadric(), at_moment.relative());
      if (contact.common) {
        if (pairs.share(rounded(midpoint(pairs.motion_a(i)(precise(*contact.common)))))) return {time, 0.0, 0.0};
        moment.lower = std::min(moment.lower, bound);
        continue;
      }
      const Separation separation{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), rounded(contact.vector),
                                  rounded(contact.on_a), rounded(contact.on_b)};
      moment.upper = std::min(moment.upper, at_moment.distance(separation).hi);
      moment.lower = std::min(moment.lower, std::max(bound, moving.lower_by_vector(i, j, separation.vector, reach)));
    }
    return moment;
  }

 private:
  [[nodiscard]] SteadyMotion motion_of(std::size_t leg) const {
    if (poses_.size() == 1) return {};
    const Vector3<double> spin = path_.spin(leg);
    const auto exact = [](const Interval& x) { return PreciseInterval(Real(x.lower()), Real(x.upper())); };
    return {precise(poses_[leg + 1].translation) - precise(poses_[leg].translation),
            {exact(spin[0]), exact(spin[1]), exact(spin[2])}};
  }

  std::span<const Pose> poses_;
  RigidPath path_;
  PosedPrimitives a_;
  PosedPrimitives b_;
  double shortest_;
};

std::array<Stretch, 2> halves(const Stretch& stretch) {
  const double middle = middle_of(stretch);
  return {Stretch{stretch.leg, stretch.begin, middle, stretch.lower},
          Stretch{stretch.leg, middle, stretch.end, stretch.lower}};
}

/// Of the largest length at hand: what single distances are proven to, with room for their rounding to binary64.
constexpr double finest_width = 0x1p-43;

class PathSearch {
 public:
  PathSearch(const Motion& motion, const PathDistanceOptions& options)
      : motion_(motion), options_(options), tolerance_(std::max(options.tolerance, finest_width * motion.size())) {}

  [[nodiscard]] PathDistance run() {
    for (const double time : {0.0, motion_.last_time()}) look_at({leg_of(time), time, time});
    if (!meets()) find_smallest();
    if (meets()) find_first_contact();
    result_.smallest = {std::max(0.0, result_.smallest.lo), result_.smallest.hi};
    if (meets()) {
      result_.smallest = {0.0, 0.0};
      result_.smallest_at = *result_.meet_at;
      result_.proximity = PathProximity::meeting;
    } else if (result_.smallest.lo > 0.0) {
      result_.proximity = PathProximity::apart;
      result_.apart_before = motion_.last_time();
    }
    const bool narrow = result_.smallest.hi - result_.smallest.lo <= tolerance_;
    result_.reached = meets() ? *result_.meet_at - result_.apart_before <= options_.time_tolerance
                              : narrow && result_.proximity == PathProximity::apart;
    return result_;
  }

 private:
  [[nodiscard]] bool meets() const { return result_.meet_at.has_value(); }

  [[nodiscard]] std::size_t leg_of(double time) const {
    const double last_leg = std::fmax(0.0, motion_.last_time() - 1.0);
    return static_cast<std::size_t>(std::fmin(std::floor(time), last_leg));
  }

  /// Its lower end over the stretch.
  double look_at(const Stretch& stretch) {
    const Moment moment = motion_.examine(stretch, result_.smallest.hi);
    ++result_.moments;
    if (moment.upper < result_.smallest.hi) {
      result_.smallest.hi = moment.upper;
      result_.smallest_at = moment.time;
    }
    if (moment.upper == 0.0) result_.meet_at = std::min(result_.meet_at.value_or(infinity), moment.time);
    return std::max(stretch.lower, moment.lower);
  }

  [[nodiscard]] bool stopped() {
    constexpr std::uint64_t moments_between_reports = 64;
    if (result_.moments < next_report_) return result_.interrupted;
    next_report_ = result_.moments + moments_between_reports;
    if (options_.progress) options_.progress(result_.smallest, result_.moments);
    if (options_.interrupted && options_.interrupted()) result_.interrupted = true;
    return result_.interrupted;
  }

  /// Best first, until a common point is proven or the enclosure is narrow.
  void find_smallest() {
    const auto later = [](const Stretch& x, const Stretch& y) { return x.lower > y.lower; };
    std::priority_queue<Stretch, std::vector<Stretch>, decltype(later)> open(later);
    for (const Stretch& leg : motion_.legs()) open.push(leg);
    double finest = infinity;  // of the stretches that are as short as they may be
    while (!open.empty() && !meets()) {
      Stretch stretch = open.top();
      result_.smallest.lo = std::min(finest, stretch.lower);
      if (result_.smallest.hi - result_.smallest.lo <= tolerance_ || finest <= stretch.lower) return;
      if (stopped()) return;
      open.pop();
      if (stretch.lower == -infinity) {  // not looked at yet
        stretch.lower = look_at(stretch);
        if (stretch.lower > -infinity && stretch.end > stretch.begin) {
          open.push(stretch);
          continue;
        }
      }
      if (!motion_.may_be_halved(stretch)) {
        finest = std::min(finest, stretch.lower);
        continue;
      }
      for (Stretch& half : halves(stretch)) {
        half.lower = look_at(half);
        open.push(half);
      }
    }
    if (open.empty()) result_.smallest.lo = finest;
  }

  /// From the beginning on, until what is left before the earliest known contact is short.
  void find_first_contact() {
    std::vector<Stretch> open = motion_.legs();
    std::ranges::reverse(open);  // the earliest last
    while (!open.empty() && !stopped()) {
      Stretch stretch = open.back();
      open.pop_back();
      result_.apart_before = stretch.begin;
      if (*result_.meet_at - stretch.begin <= options_.time_tolerance) return;
      const Moment moment = motion_.examine(stretch, 0.0);
      ++result_.moments;
      if (moment.upper == 0.0) result_.meet_at = std::min(*result_.meet_at, moment.time);
      if (moment.lower > 0.0) {
        result_.apart_before = stretch.end;
        continue;
      }
      if (!motion_.may_be_halved(stretch)) return;
      for (const Stretch& half : {halves(stretch)[1], halves(stretch)[0]}) {
        if (half.begin < *result_.meet_at) open.push_back(half);
      }
    }
  }

  const Motion& motion_;
  const PathDistanceOptions& options_;
  double tolerance_;
  std::uint64_t next_report_ = 0;
  PathDistance result_{{-infinity, infinity}, 0.0, PathProximity::undecided, 0.0, std::nullopt, false, false, 0};
};

/// Half a turn has two ways of the same angle, and rounding would choose one.
void check_turns(std::span<const Pose> path) {
  constexpr double nearly = 1e-9;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const auto& p = path[k - 1].quaternion;
    const auto& q = path[k].quaternion;
    const double sizes = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3])) *
                         std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    const double product = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    if (!(std::abs(product) <= nearly * sizes)) continue;
    throw Error(ErrorKind::input,
                fmt::format("pose {} of the path is half a turn from the one before, which has two ways: put a pose "
                            "between them",
                            k));
  }
}

void check_tolerances(const PathDistanceOptions& options) {
  if (!(options.tolerance >= 0.0)) throw Error(ErrorKind::input, "distance along a path: the tolerance is below 0");
  if (!(options.time_tolerance > 0.0))
    throw Error(ErrorKind::input, "distance along a path: the tolerance of time is not above 0");
}

}  // namespace

PathDistance distance_along(std::span<const Pose> path, const Model& a, const Model& b,
                            const PathDistanceOptions& options) {
  constexpr const char* what = "distances along paths";
  require_union_of_convex(a, what);
  require_union_of_convex(b, what);
  check_path(path);
  check_turns(path);
  check_tolerances(options);
  const Motion motion(path, a, b);
  return PathSearch(motion, options).run();
}

}  // namespace verisq
