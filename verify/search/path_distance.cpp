/// Distances along ways: the search, and the search that certifies.
#include "verify/search/path_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>
#include <variant>
#include <vector>
#include <verisq/error.hpp>

#include "verify/numbers/points.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/model_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_certificate.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/path.hpp"

namespace verisq::verify {

ExaminedStretch ConvexMoments::examine(const Stretch& stretch, double enough) const {
  const double time = stretch.middle();
  const MovingPairs moving(a_, b_, {path_->enclosed_pose(time), path_->motion_of(stretch.leg), stretch.reach()});
  const PosedPairs& pairs = moving.pairs();
  ExaminedStretch moment{time, infinity, infinity};
  const auto by_spheres = [&](std::size_t k) {
    return moving.lower_by_spheres(k / pairs.size_b(), k % pairs.size_b());
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
    moment.lower = std::min(moment.lower, std::max(bound, moving.lower_by_vector(i, j, separation.vector)));
  }
  return moment;
}

namespace {

/// The share of the distance's possible change over a stretch that a search leaves open at its middle. Planes lose less
/// than the change, and a finer search costs more than it saves.
constexpr double share_of_change = 0x1p-4;

double up(const PreciseInterval& x) {
  return x.upper().to_double(Direction::up);
}

/// The smaller one, of numbers that both bound the same.
PreciseInterval less(const PreciseInterval& x, const PreciseInterval& y) {
  return x.upper() < y.upper() ? x : y;
}

/// A sphere that contains the model, in the model's own frame.
EnclosingSphere sphere_about(const Model& model) {
  const Box box = bounding_box(model);
  Point middle;
  for (std::size_t i = 0; i < 3; ++i) middle[i] = std::midpoint(box.lower[i], box.upper[i]);
  const PreciseVector centre = precise(middle);
  // The radius reaches the farther corner: the middle is rounded.
  PreciseVector corner;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval to_lower = abs(centre[i] - PreciseInterval(Real(box.lower[i])));
    const PreciseInterval to_upper = abs(PreciseInterval(Real(box.upper[i])) - centre[i]);
    corner[i] = to_lower.upper() > to_upper.upper() ? to_lower : to_upper;
  }
  return {centre, length<Real>(corner)};
}

}  // namespace

SpeedMoments::SpeedMoments(const PosedPath& path, const Model& a, const Model& b)
    : path_(&path), sphere_a_(sphere_about(a)), sphere_b_(sphere_about(b)) {}

// The distance changes no faster than points of B move in A's frame, and no faster than points of A move in B's.
PreciseInterval SpeedMoments::change(const ShortMotion& motion) const {
  const EnclosingSphere moved{motion.pose()(sphere_b_.centre), sphere_b_.radius};
  return less(motion.way_seen_of(sphere_a_), motion.way_of(moved));
}

// |(R - R') x + (t - t')| <= |(R - R') c + (t - t')| + |R - R'| r, and |R - R'| is at most the sum of its columns'
// lengths.
double SpeedMoments::displacement(const RigidMotion& exact, const RigidMotion& nearby) const {
  const PreciseVector at_centre = exact(sphere_b_.centre) - nearby(sphere_b_.centre);
  PreciseInterval spread{Real(0.0)};
  for (std::size_t j = 0; j < 3; ++j)
    spread = spread + length<Real>(PreciseVector(exact.rotation.column(j) - nearby.rotation.column(j)));
  return up(length<Real>(at_centre) + spread * sphere_b_.radius);
}

MomentInStretch SpeedMoments::moment_of(const Stretch& stretch) const {
  const double time = stretch.middle();
  const RigidMotion exact = path_->enclosed_pose(time);
  const Pose pose = path_->rounded_pose(time);
  const double off = displacement(exact, RigidMotion(pose));
  const ShortMotion motion(exact, path_->motion_of(stretch.leg), stretch.reach());
  const PreciseInterval lost = change(motion) + PreciseInterval(Real(off));
  const PreciseInterval apart = length<Real>(PreciseVector(exact(sphere_b_.centre) - sphere_a_.centre));
  const PreciseInterval between_balls = apart - sphere_a_.radius - sphere_b_.radius;
  return {time, pose, exact, off, motion, lost, (between_balls - lost).lower().to_double(Direction::down)};
}

SearchedMoments::SearchedMoments(const PosedPath& path, const Model& a, const Model& b, double tolerance,
                                 std::function<bool()> interrupted)
    : SpeedMoments(path, a, b),
      search_(a, b),
      pair_(a, b),
      tolerance_(tolerance),
      interrupted_(std::move(interrupted)) {}

bool SearchedMoments::is_in_b(const Point& x, const RigidMotion& exact) const {
  const PreciseVector place = exact.local_point(x);
  Cube cube{rounded(midpoint(place)), 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval off = abs(place[i] - PreciseInterval(Real(cube.centre[i])));
    cube.half_width = std::max(cube.half_width, up(off));
  }
  const SearchSolid& solid = search_.solid_b();
  return std::ranges::any_of(solid.parts,
                             [&](const SearchSolid::Part& part) { return strictly_inside(solid, part.set, cube); });
}

ExaminedStretch SearchedMoments::examine(const Stretch& stretch, double enough) const {
  const MomentInStretch moment = moment_of(stretch);
  const auto& [time, pose, exact, off, motion, lost, by_balls] = moment;
  if (by_balls > enough) return {time, by_balls, infinity};

  bool far = false;
  // If the question is only whether they are apart at all, the search is as fine as the stretch is short.
  const double finest = enough > 0.0 ? tolerance_ : 0.0;
  SearchOptions options{.tolerance = std::max(0.25 * finest, share_of_change * up(lost))};
  options.progress = [&](const Enclosure& distance, std::uint64_t) { far = moment.over_stretch(distance.lo) > enough; };
  options.interrupted = [&] { return far || (interrupted_ && interrupted_()); };
  const SearchedDistance found = search_(pose, options);
  if (found.common && is_in_b(*found.common, exact)) return {time, 0.0, 0.0};
  double lower = std::max(by_balls, moment.over_stretch(found.distance.lo));
  if (lower < std::min(enough, found.distance.lo)) {
    options.progress = {};
    const PairCertificate planes = search_.planes(pose, found, options);
    lower = std::max(lower, pair_.lower(motion, planes));
  }
  return {time, lower, up(PreciseInterval(Real(found.distance.hi)) + PreciseInterval(Real(off)))};
}

/// Solids that meet deeper than the pose is rounded meet at the exact pose.
ExaminedStretch MeshMoments::examine(const Stretch& stretch, double enough) const {
  const MomentInStretch moment = moment_of(stretch);
  if (moment.by_balls > enough) return {moment.time, moment.by_balls, infinity};
  const MeshPair found = distance_(moment.pose, interrupted_);
  if (found.depth > moment.off) return {moment.time, 0.0, 0.0};
  return {moment.time, std::max(moment.by_balls, moment.over_stretch(found.distance.lo)),
          up(PreciseInterval(Real(found.distance.hi)) + PreciseInterval(Real(moment.off)))};
}

}  // namespace verisq::verify

namespace verisq {

using namespace verify;

namespace {

double largest_translation(std::span<const Pose> poses) {
  double largest = 0.0;
  for (const Pose& pose : poses) largest = std::max(largest, largest_coordinate(pose.translation));
  return largest;
}

/// The largest length at hand.
double size_of(std::span<const Pose> poses, const Model& a, const Model& b) {
  double size = 0.0;
  for (const Model* model : {&a, &b}) {
    const Box box = bounding_box(*model);
    for (std::size_t i = 0; i < 3; ++i) size = std::max({size, std::abs(box.lower[i]), std::abs(box.upper[i])});
  }
  return std::max(size, largest_translation(poses));
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

/// Share of the largest length involved: the width to which single distances are proven, with room for their rounding
/// to binary64.
constexpr double finest_width = 0x1p-43;

class PathSearch {
 public:
  /// Reports, and polls for interruptions, after so many moments.
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

  /// The lower end of the distance over the stretch.
  double look_at(const Stretch& stretch) {
    const ExaminedStretch moment = moments_.examine(stretch, result_.smallest.hi);
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

  /// Works from the beginning, until the interval before the earliest known contact is short.
  void find_first_contact() {
    std::vector<Stretch> open = legs_of(path_);
    std::ranges::reverse(open);  // the earliest last
    while (!open.empty() && !stopped()) {
      Stretch stretch = open.back();
      open.pop_back();
      result_.apart_before = stretch.begin;
      if (*result_.meet_at - stretch.begin <= options_.time_tolerance) return;
      const ExaminedStretch moment = moments_.examine(stretch, 0.0);
      ++result_.moments;
      if (moment.upper == 0.0) result_.meet_at = std::min(*result_.meet_at, moment.time);
      if (moment.lower > 0.0) {
        result_.apart_before = stretch.end;
        continue;
      }
      if (!may_be_halved(stretch)) return look_a_little_later(stretch);
      for (const Stretch& half : {halves(stretch)[1], halves(stretch)[0]}) {
        if (half.begin < *result_.meet_at) open.push_back(half);
      }
    }
  }

  /// Where solids begin to touch, roundings hide whether they do: a little later they meet.
  void look_a_little_later(const Stretch& stretch) {
    const double later = std::min(stretch.begin + 0.5 * options_.time_tolerance, path_.last_time());
    const ExaminedStretch moment = moments_.examine({leg_of(later), later, later}, 0.0);
    ++result_.moments;
    if (moment.upper == 0.0) result_.meet_at = std::min(*result_.meet_at, later);
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

PathDistance followed(std::span<const Pose> path, const Model& a, const Model& b, const PathDistanceOptions& options) {
  const PosedPath posed(path);
  const double tolerance = std::max(options.tolerance, finest_width * size_of(path, a, b));
  if (is_union_of_convex(a) && is_union_of_convex(b)) {
    constexpr std::uint64_t many = 64;  // it takes milliseconds
    return PathSearch(posed, ConvexMoments(posed, a, b), tolerance, options, many).run();
  }
  if (has_mesh(a) || has_mesh(b))
    return PathSearch(posed, MeshMoments(posed, a, b, options.interrupted), tolerance, options, 1).run();
  const SearchedMoments moments(posed, a, b, tolerance, options.interrupted);
  return PathSearch(posed, moments, tolerance, options, 1).run();
}

/// Nothing if scaling is not exact.
std::optional<std::vector<Pose>> in_units(std::span<const Pose> path, double unit) {
  std::vector<Pose> scaled;
  for (const Pose& pose : path) {
    const std::optional<Pose> in_unit = verify::in_units(pose, unit);
    if (!in_unit) return std::nullopt;
    scaled.push_back(*in_unit);
  }
  return scaled;
}

}  // namespace

PathDistance distance_along(std::span<const Pose> path, const Model& a, const Model& b,
                            const PathDistanceOptions& options) {
  for (const Model* const model : {&a, &b}) verify::require_valid_with_meshes(*model);
  check_path(path);
  check_turns(path);
  check_tolerances(options);
  const double unit = unit_of(a, b, largest_translation(path));
  const std::optional<std::vector<Pose>> scaled = unit == 1.0 ? std::nullopt : in_units(path, unit);
  if (!scaled) return followed(path, a, b, options);
  PathDistanceOptions scaled_options = options;
  scaled_options.tolerance = tolerance_in_units(options.tolerance, unit);
  if (options.progress) {
    scaled_options.progress = [&](const Enclosure& smallest, std::uint64_t moments) {
      options.progress(in_lengths(smallest, unit), moments);
    };
  }
  PathDistance found = followed(*scaled, verify::in_units(a, unit), verify::in_units(b, unit), scaled_options);
  found.smallest = in_lengths(found.smallest, unit);
  return found;
}

namespace {

/// The number of parts beyond the number of poses: if more would be needed, less is proven.
constexpr std::size_t most_further_parts = 16384;
/// Share of the tolerance for the loss of a part by its length, and below for single moments.
constexpr double share_of_parts = 0.0625;
constexpr double share_of_moments = 0.25;

class PathProver {
 public:
  PathProver(std::span<const Pose> path, const Model& a, const Model& b, const PathDistanceOptions& options)
      : options_(options),
        path_(path),
        distances_(a, b, share_of_moments * options.tolerance),
        has_meshes_(has_mesh(a) || has_mesh(b)),
        checker_(a, b, path),
        most_parts_(path.size() + most_further_parts) {
    if (!has_meshes_ && !(is_union_of_convex(a) && is_union_of_convex(b)))
      places_ = {verify::ExactChecker(a), verify::ExactChecker(b)};
  }

  [[nodiscard]] CertifiedPath operator()(const PathDistance& found) {
    const double lower = found.smallest.lo;
    const bool apart = found.proximity == PathProximity::apart;
    // Before a contact, any lower end above 0 proves that it has not happened yet.
    goal_ = apart ? std::max(lower - share_of_parts * options_.tolerance, 0.5 * lower)
                  : std::numeric_limits<double>::denorm_min();
    prove_parts(apart ? path_.last_time() : found.apart_before);
    const double nearest = found.meet_at.value_or(found.smallest_at);
    certificate_.nearest = nearest;
    certificate_.at_nearest = distance_at(nearest).certificate;
    PathClaims claims = checker_.prove(certificate_, {});
    if (claims.smallest.lo > 0.0) claims.first_contact.reset();  // that there is none says nothing more
    return {claims, std::move(certificate_), interrupted_};
  }

 private:
  [[nodiscard]] bool stopped() {
    interrupted_ = interrupted_ || (options_.interrupted && options_.interrupted());
    return interrupted_;
  }

  [[nodiscard]] verisq::CertifiedDistance distance_at(double time) {
    return distances_(path_.rounded_pose(time), [this] { return stopped(); });
  }

  /// Proves parts from the beginning, as long as they reach the goal. A path of one pose is one part.
  void prove_parts(double end) {
    double begin = 0.0;
    do {
      const double until = std::min(end, begin + 1.0);
      if (!prove(begin, until, {})) return;
      begin = until;
    } while (begin < end);
  }

  /// Appends parts from `begin` to `end`, halved until each reaches the goal, or the bound that may be hoped for there.
  /// `hint` was enough nearby. False if a part proves nothing.
  [[nodiscard]] bool prove(double begin, double end, const PairCertificate& hint) {  // NOLINT(misc-no-recursion)
    if (stopped()) return false;
    if (add_if(goal_, begin, {end, {}}) || (!has_meshes_ && add_if(goal_, begin, {end, hint}))) return true;
    const double middle = 0.5 * (begin + end);
    auto [distance, certificate] = distance_at(middle);
    const double hoped =
        distance.lo >= goal_ ? goal_ : std::max(distance.lo - share_of_moments * options_.tolerance, 0.5 * distance.lo);
    if (!(hoped > 0.0)) return false;
    for (SurroundedPrimitive& cover : certificate.covers_b) widen(cover, begin, end, hoped);
    const PathPart part{end, without_points(std::move(certificate))};
    if (add_if(hoped, begin, part)) return true;
    const bool spent = certificate_.parts.size() >= most_parts_ || !(begin < middle && middle < end);
    if (spent) return add_if(std::numeric_limits<double>::denorm_min(), begin, part);
    return prove(begin, middle, part.certificate) && prove(middle, end, part.certificate);
  }

  [[nodiscard]] bool add_if(double at_least, double begin, const PathPart& part) {
    if (!(checker_.lower(begin, part) >= at_least)) return false;
    certificate_.parts.push_back(part);
    if (options_.progress) options_.progress({goal_, infinity}, certificate_.parts.size());
    return true;
  }

  /// Extends the cover from the moment to all places in the part, to the hoped-for distance. If that takes too many
  /// cells, the cover stays unchanged and proves nothing for the part.
  void widen(SurroundedPrimitive& cover, double begin, double end, double hoped) {
    const auto& [a, b] = *places_;
    const auto& convex = std::get<verify::PosedSuperquadric>(b.primitives()[cover.primitive]);
    const verify::PosedBody body(convex, path_.motion_between(begin, end));
    const verify::EmptyNeighbourhood around(a.set(), a.primitives(), body, body.centre(), hoped);
    const auto cells = verify::cover_of(around, verify::most_cells_about_a_primitive, [this] { return stopped(); });
    if (cells) cover = {cover.primitive, hoped, *cells};
  }

  /// Points prove nothing from below.
  [[nodiscard]] static PairCertificate without_points(PairCertificate certificate) {
    for (Separation& separation : certificate.separations) separation.on_a = separation.on_b = {};
    certificate.near_points.reset();
    certificate.common.reset();
    return certificate;
  }

  const PathDistanceOptions& options_;
  verify::PosedPath path_;
  CertifiedDistances distances_;
  std::optional<std::array<verify::ExactChecker, 2>> places_;  ///< for models that have covers
  bool has_meshes_;                                            ///< their distances need no certificates
  PathChecker checker_;
  std::size_t most_parts_;
  double goal_ = 0.0;
  PathCertificate certificate_;
  bool interrupted_ = false;
};

}  // namespace

CertifiedPath certified_path(std::span<const Pose> path, const Model& a, const Model& b, const PathDistance& found,
                             const PathDistanceOptions& options) {
  return PathProver(path, a, b, options)(found);
}

}  // namespace verisq
