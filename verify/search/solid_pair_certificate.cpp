/// The balls and covers of solid_pair_distance.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "verify/proof/solid_pair.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_certificate.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t kMostPrimitives = 64;  // some searches each
constexpr double kNearlyRound = 1.25;        // the largest distance from the centre, over the least
constexpr Enclosure kNothingKnown{-infinity, infinity};

void append_hollows(const SetNode& node, const Model& model, std::vector<Ball>& result) {
  if (node.kind == SetNode::Kind::leaf && node.side == Side::outside) {
    const Primitive& primitive = model.primitives[node.primitive];
    if (is_ball(primitive)) result.push_back({primitive.pose.translation, primitive.superquadric.semi_axes[0]});
  }
  for (const SetNode& operand : node.operands) append_hollows(operand, model, result);
}

/// About the μ with the least bound: the bound is convex in μ, and the search runs over ln(μ / (largest b²) - 1).
double multiplier(const std::array<double, 3>& b, const std::array<double, 3>& c) {
  const double largest = std::ranges::max(b) * std::ranges::max(b);
  const auto bound = [&](double exponent) {
    const double mu = largest * (1.0 + std::exp(exponent));
    double sum = mu;
    for (std::size_t i = 0; i < 3; ++i) sum += c[i] * c[i] * mu / (mu - b[i] * b[i]);
    return sum;
  };
  double low = -36.0;  // a few roundings of the square
  double high = 40.0;
  for (int i = 0; i < 120; ++i) {
    const double third = (high - low) / 3.0;
    (bound(low + third) < bound(high - third) ? high : low) =
        bound(low + third) < bound(high - third) ? high - third : low + third;
  }
  return largest * (1.0 + std::exp(0.5 * (low + high)));
}

}  // namespace

std::vector<Ball> hollows(const Model& model) {
  std::vector<Ball> result;
  append_hollows(normal_form(model, Side::inside), model, result);
  return result;
}

double multiplier_about(const Primitive& primitive, const Point& x) {
  const PreciseVector centre = RigidMotion(primitive.pose).local_point(x);
  std::array<double, 3> about{};
  for (std::size_t i = 0; i < 3; ++i) about[i] = centre[i].upper().to_double(Direction::up);
  return multiplier(semi_axes_of_ellipsoid(primitive.superquadric), about);
}

double farthest_up(const Primitive& primitive, const Point& x) {
  return farthest_up(primitive, precise(x), multiplier_about(primitive, x));
}

std::optional<EnclosingBalls> EnclosingBalls::of(const Model& model) {
  if (!is_union_of_convex(model) || model.primitives.size() > kMostPrimitives) return std::nullopt;
  return EnclosingBalls(model.primitives);
}

bool EnclosingBalls::all_are_balls() const {
  return std::ranges::all_of(primitives_, is_ball);
}

std::vector<Ball> enclosing_balls(const Primitive& primitive, std::span<const Ball> hollows) {
  const Point& own_centre = primitive.pose.translation;
  if (is_ball(primitive)) return {{own_centre, primitive.superquadric.semi_axes[0]}};
  if (hollows.empty()) return {};
  std::vector<Ball> result;
  Ball widest{{}, infinity};
  double room = 0.0;
  for (const auto& [centre, radius] : hollows) {
    const double farthest = farthest_up(primitive, centre);
    if (!(radius - farthest > room)) continue;
    room = radius - farthest;
    widest = {centre, farthest};
  }
  if (room > 0.0) result.push_back(widest);
  const double about_own_centre = farthest_up(primitive, own_centre);
  if (about_own_centre <= kNearlyRound * std::ranges::min(primitive.superquadric.semi_axes)) {
    result.push_back({own_centre, about_own_centre});
  }
  return result;
}

double EnclosingBalls::lower_from(const SolidDistance& solid, std::span<const Ball> hollows,
                                  const std::function<Located(const Point&)>& locate, double tolerance,
                                  const std::function<bool()>& interrupted) const {
  std::vector<std::vector<Ball>> balls;
  for (const Primitive& primitive : primitives_) {
    balls.push_back(enclosing_balls(primitive, hollows));
    if (balls.back().empty()) return -infinity;
  }
  double least = infinity;
  for (const std::vector<Ball>& about_one : balls) {
    double greatest = -infinity;
    for (const auto& [centre, radius] : about_one) {
      const auto [own, off] = locate(centre);
      const double lo = solid(own, tolerance, kNothingKnown, interrupted).lo;
      // The search of pairs uses this number if there is no solid.
      if (lo == std::numeric_limits<double>::max()) return -infinity;
      greatest = std::max(greatest, subtract(subtract(lo, off, Direction::down), radius, Direction::down));
    }
    least = std::min(least, greatest);
  }
  return least;
}

double EnclosingBalls::lower_from_b(const SolidDistance& b, std::span<const Ball> hollows_of_b,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const {
  std::vector<Ball> moved(hollows_of_b.begin(), hollows_of_b.end());
  for (Ball& hollow : moved) hollow.centre = motion.to_a(hollow.centre);
  const auto locate = [&](const Point& centre) {
    const Cube cube = motion.enclosed_in_b(centre);
    return Located{cube.centre, (sqrt(Interval(3)) * Interval(cube.half_width)).upper()};
  };
  return lower_from(b, moved, locate, tolerance, interrupted);
}

double EnclosingBalls::lower_from_a(const SolidDistance& a, std::span<const Ball> hollows_of_a,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const {
  std::vector<Ball> moved(hollows_of_a.begin(), hollows_of_a.end());
  for (Ball& hollow : moved) hollow.centre = motion.to_b(hollow.centre);
  const auto locate = [&](const Point& centre) {
    const Point own = motion.to_a(centre);
    return Located{own, motion.distance_up(own, centre)};
  };
  return lower_from(a, moved, locate, tolerance, interrupted);
}

namespace {

constexpr std::uint64_t kMostSteps = 4096;  // pairs of sections; some forty decide where bent stems lie side by side

/// Adds the primitives that contain the set. For an intersection one of them is enough; which one is not known
/// beforehand.
void add_holding(const SetNode& set, std::set<std::uint32_t>& result) {
  if (set.kind == SetNode::Kind::leaf && set.side == Side::inside) result.insert(set.primitive);
  for (const SetNode& operand : set.operands) add_holding(operand, result);
}

std::set<std::uint32_t> holding_primitives(const SearchSolid& solid) {
  std::set<std::uint32_t> result;
  for (const SearchSolid::Part& part : solid.parts) add_holding(part.set, result);
  return result;
}

Point rounded(const PreciseVector& x) {
  Point result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = x[i].lower().to_double(Direction::down);
  return result;
}

/// One pose's planes, balls and covers.
class Certification {
 public:
  using Stop = std::function<bool()>;

  /// The lower end of `distance` is to be proven.
  Certification(const SearchedModel& a, const SearchedModel& b, const Pose& pose, const Enclosure& distance,
                double tolerance, Stop interrupted)
      : a_(&a),
        b_(&b),
        pose_(pose),
        motion_(pose),
        distance_(distance.lo),
        witnessed_(distance.hi),
        tolerance_(tolerance),
        interrupted_(std::move(interrupted)) {}

  void add_planes(PairCertificate& certificate) {
    for (const std::uint32_t i : holding_primitives(a_->solid)) {
      for (const std::uint32_t j : holding_primitives(b_->solid)) {
        const SeparablePrimitive& one = a_->solid.separable[i];
        const SeparablePrimitive& other = b_->solid.separable[j];
        if (is_far(one, other)) continue;
        PrimitivePairDistance pair(one, other, pose_, tolerance_ / 4);
        (void)pair.raise(distance_, kMostSteps, interrupted_);
        if (pair.lower() > 0.0) certificate.divisions.push_back(pair.certificate(i, j));
        if (!(pair.lower() >= distance_)) open_.insert({i, j});
        if (interrupted_()) return;
      }
    }
  }

  /// About primitives that planes leave open.
  void add_balls(PairCertificate& certificate) {
    if (open_.empty()) return;
    std::set<std::uint32_t> of_a;
    for (const auto& [i, j] : open_) of_a.insert(i);
    std::set<std::uint32_t> held_a;
    std::set<std::uint32_t> held_b;
    certificate.balls_a = balls(*a_, *b_, motion_.inverse(), of_a, held_a);
    const auto has_ball = [&](std::uint32_t i) {
      return std::ranges::any_of(certificate.balls_a, [i](const EnclosingBall& ball) { return ball.primitive == i; });
    };
    std::set<std::uint32_t> of_b;
    for (const auto& [i, j] : open_) {
      if (!has_ball(i)) of_b.insert(j);
    }
    certificate.balls_b = balls(*b_, *a_, motion_, of_b, held_b);
    std::erase_if(open_, [&](const auto& pair) { return held_a.contains(pair.first) || held_b.contains(pair.second); });
  }

  /// About primitives that balls leave open, too.
  void add_covers(PairCertificate& certificate) {
    std::set<std::uint32_t> of_b;
    for (const auto& [i, j] : open_) of_b.insert(j);
    for (const std::uint32_t j : of_b) add_cover(*b_, *a_, motion_, j, certificate.covers_b);
    close(certificate.covers_b, [](const auto& pair) { return pair.second; });
    std::set<std::uint32_t> of_a;
    for (const auto& [i, j] : open_) of_a.insert(i);
    for (const std::uint32_t i : of_a) add_cover(*a_, *b_, motion_.inverse(), i, certificate.covers_a);
  }

 private:
  /// Returns whether spheres prove it, too, by far.
  [[nodiscard]] bool is_far(const SeparablePrimitive& a, const SeparablePrimitive& b) const {
    const PreciseVector between = motion_(precise(b.centre)) - precise(a.centre);
    const double centres = length<Real>(between).lower().to_double(Direction::down);
    return centres - a.reach - b.reach > distance_;
  }

  /// Balls that may prove the distance, about primitives of `one`; the motion leads to the frame of the other. `held`
  /// gets the primitives whose balls do.
  [[nodiscard]] std::vector<EnclosingBall> balls(const SearchedModel& one, const SearchedModel& other,
                                                 const RigidMotion& to_other, const std::set<std::uint32_t>& of,
                                                 std::set<std::uint32_t>& held) const {
    if (of.empty()) return {};
    std::vector<Ball> hollows_of_other = hollows(other.model);
    for (Ball& hollow : hollows_of_other) hollow.centre = rounded(to_other.inverse()(precise(hollow.centre)));
    const SignedDistance distance(other.model);
    std::vector<EnclosingBall> result;
    for (const std::uint32_t i : of) {
      const Primitive& primitive = one.model.primitives[i];
      std::optional<EnclosingBall> best;
      double greatest = 0.0;
      for (const auto& [centre, radius] : enclosing_balls(primitive, hollows_of_other)) {
        const Point seen = rounded(to_other(precise(centre)));
        const auto [known, proof] = distance.certified(seen, tolerance_ / 4, interrupted_);
        if (!(known.lo - radius > greatest)) continue;
        greatest = known.lo - radius;
        best = EnclosingBall{i, seen, multiplier_about(primitive, centre), known.lo, proof};
      }
      if (best) result.push_back(*best);
      if (greatest >= distance_ - tolerance_ / 2) held.insert(i);
    }
    return result;
  }

  /// About a primitive of `one`; the motion leads to the frame of the other.
  void add_cover(const SearchedModel& one, const SearchedModel& other, const RigidMotion& to_other, std::uint32_t index,
                 std::vector<SurroundedPrimitive>& covers) const {
    const auto* const convex = std::get_if<PosedSuperquadric>(&one.places.primitives()[index]);
    if (convex == nullptr || interrupted_()) return;
    const PosedBody body(*convex, ShortMotion(to_other));
    const auto neighbourhood = [&](double radius, const std::vector<Normal>&) {
      return EmptyNeighbourhood(other.places.set(), other.places.primitives(), body, body.centre(), radius);
    };
    const auto found =
        empty_radius({[](double) { return std::vector<Normal>(); }, neighbourhood, most_cells_about_a_primitive},
                     witnessed_, tolerance_, interrupted_);
    if (found) covers.push_back({index, found->radius, found->cover});
  }

  /// Drops pairs of which one primitive has a cover.
  template <class IndexOf>
  void close(const std::vector<SurroundedPrimitive>& covers, const IndexOf& index_of) {
    std::erase_if(open_, [&](const auto& pair) {
      return std::ranges::any_of(covers, [&](const SurroundedPrimitive& cover) {
        return cover.primitive == index_of(pair) && cover.distance >= distance_;
      });
    });
  }

  const SearchedModel* a_;
  const SearchedModel* b_;
  Pose pose_;
  RigidMotion motion_;  ///< from the frame of B to that of A
  double distance_;     ///< the distance to be proven
  double witnessed_;    ///< the distance is no more
  double tolerance_;
  Stop interrupted_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> open_;  ///< primitives that planes do not hold apart so far
};

}  // namespace

PairCertificate planes_between(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                               const SearchedDistance& found, const SearchOptions& options) {
  PairCertificate result;
  Certification(a, b, pose, found.distance, options.tolerance, [&] {
    return options.interrupted && options.interrupted();
  }).add_planes(result);
  return result;
}

PairCertificate certificate_of(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                               const SearchedDistance& found, const SearchOptions& options) {
  PairCertificate result{.near_points = found.near_points, .common = found.common};
  if (!(found.distance.lo > 0.0)) return result;
  Certification certification(a, b, pose, found.distance, options.tolerance,
                              [&] { return options.interrupted && options.interrupted(); });
  certification.add_planes(result);
  certification.add_balls(result);
  certification.add_covers(result);
  return result;
}

}  // namespace verisq::verify
