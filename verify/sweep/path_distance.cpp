/// Halves the stretches of time in which the smallest distance, or the first contact, may be.
#include "verisq/path_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>
#include <verisq/error.hpp>

#include "verify/placement/path_check.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verify/sweep/convex_moments.hpp"
#include "verify/sweep/searched_moments.hpp"

namespace verisq {

using namespace verify;

namespace {

/// The largest length at hand.
double size_of(std::span<const Pose> poses, const Model& a, const Model& b) {
  double size = 0.0;
  for (const Model* model : {&a, &b}) {
    const Box box = bounding_box(*model);
    for (std::size_t i = 0; i < 3; ++i) size = std::max({size, std::abs(box.lower[i]), std::abs(box.upper[i])});
  }
  for (const Pose& pose : poses) {
    for (const double t : pose.translation) size = std::max(size, std::abs(t));
  }
  return size;
}

std::vector<Stretch> legs_of(const PosedPath& path) {
  std::vector<Stretch> legs;
  for (std::size_t k = 0; k + 1 < path.poses().size(); ++k)
    legs.push_back({k, static_cast<double>(k), static_cast<double>(k + 1)});
  if (legs.empty()) legs.push_back({0, 0.0, 0.0});
  return legs;
}

std::array<Stretch, 2> halves(const Stretch& stretch) {
  const double middle = stretch.middle();  // exact: both ends are multiples of `shortest`, which has a half
  return {Stretch{stretch.leg, stretch.begin, middle, stretch.lower},
          Stretch{stretch.leg, middle, stretch.end, stretch.lower}};
}

/// Of the largest length at hand: what single distances are proven to, with room for their rounding to binary64.
constexpr double finest_width = 0x1p-43;

class PathSearch {
 public:
  /// Reports and asks for interruptions after so many moments.
  PathSearch(const PosedPath& path, const PathMoments& moments, double tolerance, const PathDistanceOptions& options,
             std::uint64_t moments_between_reports)
      : path_(path),
        moments_(moments),
        options_(options),
        tolerance_(tolerance),
        shortest_(std::fmax(0x1p-40, std::ldexp(path.last_time(), -50))),
        moments_between_reports_(moments_between_reports) {}

  [[nodiscard]] PathDistance run() {
    for (const double time : {0.0, path_.last_time()}) look_at({leg_of(time), time, time});
    if (!meets()) find_smallest();
    if (meets()) find_first_contact();
    result_.smallest = {std::max(0.0, result_.smallest.lo), result_.smallest.hi};
    if (meets()) {
      result_.smallest = {0.0, 0.0};
      result_.smallest_at = *result_.meet_at;
      result_.proximity = PathProximity::meeting;
    } else if (result_.smallest.lo > 0.0) {
      result_.proximity = PathProximity::apart;
      result_.apart_before = path_.last_time();
    }
    const bool narrow = result_.smallest.hi - result_.smallest.lo <= tolerance_;
    result_.reached = meets() ? *result_.meet_at - result_.apart_before <= options_.time_tolerance
                              : narrow && result_.proximity == PathProximity::apart;
    return result_;
  }

 private:
  [[nodiscard]] bool may_be_halved(const Stretch& stretch) const { return stretch.end - stretch.begin > shortest_; }

  [[nodiscard]] bool meets() const { return result_.meet_at.has_value(); }

  [[nodiscard]] std::size_t leg_of(double time) const {
    const double last_leg = std::fmax(0.0, path_.last_time() - 1.0);
    return static_cast<std::size_t>(std::fmin(std::floor(time), last_leg));
  }

  /// Its lower end over the stretch.
  double look_at(const Stretch& stretch) {
    const Moment moment = moments_.examine(stretch, result_.smallest.hi);
    ++result_.moments;
    if (moment.upper < result_.smallest.hi) {
      result_.smallest.hi = moment.upper;
      result_.smallest_at = moment.time;
    }
    if (moment.upper == 0.0) result_.meet_at = std::min(result_.meet_at.value_or(infinity), moment.time);
    return std::max(stretch.lower, moment.lower);
  }

  [[nodiscard]] bool stopped() {
    if (result_.moments < next_report_) return result_.interrupted;
    next_report_ = result_.moments + moments_between_reports_;
    if (options_.progress) options_.progress(result_.smallest, result_.moments);
    if (options_.interrupted && options_.interrupted()) result_.interrupted = true;
    return result_.interrupted;
  }

  /// Best first, until a common point is proven or the enclosure is narrow.
  void find_smallest() {
    const auto later = [](const Stretch& x, const Stretch& y) { return x.lower > y.lower; };
    std::priority_queue<Stretch, std::vector<Stretch>, decltype(later)> open(later);
    for (const Stretch& leg : legs_of(path_)) open.push(leg);
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
      if (!may_be_halved(stretch)) {
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
    std::vector<Stretch> open = legs_of(path_);
    std::ranges::reverse(open);  // the earliest last
    while (!open.empty() && !stopped()) {
      Stretch stretch = open.back();
      open.pop_back();
      result_.apart_before = stretch.begin;
      if (*result_.meet_at - stretch.begin <= options_.time_tolerance) return;
      const Moment moment = moments_.examine(stretch, 0.0);
      ++result_.moments;
      if (moment.upper == 0.0) result_.meet_at = std::min(*result_.meet_at, moment.time);
      if (moment.lower > 0.0) {
        result_.apart_before = stretch.end;
        continue;
      }
      if (!may_be_halved(stretch)) return;
      for (const Stretch& half : {halves(stretch)[1], halves(stretch)[0]}) {
        if (half.begin < *result_.meet_at) open.push_back(half);
      }
    }
  }

  const PosedPath& path_;
  const PathMoments& moments_;
  const PathDistanceOptions& options_;
  double tolerance_;
  double shortest_;
  std::uint64_t moments_between_reports_;
  std::uint64_t next_report_ = 0;
  PathDistance result_{{-infinity, infinity}, 0.0, PathProximity::undecided, 0.0, std::nullopt, false, false, 0};
};

void check_tolerances(const PathDistanceOptions& options) {
  if (!(options.tolerance >= 0.0)) throw Error(ErrorKind::input, "distance along a path: the tolerance is below 0");
  if (!(options.time_tolerance > 0.0))
    throw Error(ErrorKind::input, "distance along a path: the tolerance of time is not above 0");
}

}  // namespace

PathDistance distance_along(std::span<const Pose> path, const Model& a, const Model& b,
                            const PathDistanceOptions& options) {
  check_path(path);
  check_turns(path);
  check_tolerances(options);
  const PosedPath posed(path);
  const double tolerance = std::max(options.tolerance, finest_width * size_of(path, a, b));
  if (is_union_of_convex(a) && is_union_of_convex(b)) {
    constexpr std::uint64_t many = 64;  // it takes milliseconds
    return PathSearch(posed, ConvexMoments(posed, a, b), tolerance, options, many).run();
  }
  const SearchedMoments moments(posed, a, b, tolerance, options.interrupted);
  return PathSearch(posed, moments, tolerance, options, 1).run();
}

}  // namespace verisq
