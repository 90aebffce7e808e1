/// Separates every two primitives once more, and keeps the planes; where they do not decide, tries the balls of
/// enclosing_balls.hpp, then covers.
#include "verify/sets/solid_pair_certificate.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "verify/pairs/posed_body.hpp"
#include "verify/sets/cover_search.hpp"
#include "verify/sets/enclosing_balls.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::verify {

namespace {

constexpr std::uint64_t kMostSteps = 4096;  // pairs of sections; some forty decide where bent stems lie side by side

/// Of an intersection one of them is enough; which one, nothing tells beforehand.
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

  /// To be proven is the lower end of `distance`.
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
  /// Whether spheres prove it, too, by far.
  [[nodiscard]] bool is_far(const SeparablePrimitive& a, const SeparablePrimitive& b) const {
    const PreciseVector between = motion_(precise(b.centre)) - precise(a.centre);
    const double centres = length<Real>(between).lower().to_double(Direction::down);
    return centres - a.reach - b.reach > distance_;
  }

  /// Those that may prove the distance, about primitives of `one`; the motion leads to the frame of the other. The
  /// primitives of which they do are `held`.
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

  /// Pairs of which one has a cover.
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
  double distance_;     ///< what is to be proven
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
