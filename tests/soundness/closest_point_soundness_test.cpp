/// Soundness of closest points: no box misses the closest point, and none that is said to be the only one is not.
///
/// Random solids, poses and points of tests/oracle/random_cases.hpp against MPFR at 200 bits, and tapered solids with
/// queries above known points of their surfaces. VERISQ_SOUNDNESS_CASES sets the number of cases. The full run is
///   VERISQ_SOUNDNESS_CASES=100000 build/release/tests/soundness_test --gtest_filter='ClosestPointSoundness*'
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <string>
#include <vector>
#include <verisq/signed_distance.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/reference_distance.hpp"
#include "tests/oracle/tapered_contact.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t queries_a_solid = 40;
constexpr std::size_t usual_queries = 240;

/// Whether every coordinate of some point within `radius` of `centre` may lie in the box.
bool meets(const EnclosedPoint& box, const Vector& centre, const Real& radius) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(Real(box[k].lo) <= centre[k] + radius && Real(box[k].hi) >= centre[k] - radius)) return false;
  }
  return true;
}

double widest(const EnclosedPoint& box) {
  return std::max({box[0].width(), box[1].width(), box[2].width()});
}

std::string described(const Primitive& primitive, const Point& x, const ClosestPoint& found, const Vector& reference) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  return fmt::format(
      "{} box [{:.17g} {:.17g}] [{:.17g} {:.17g}] [{:.17g} {:.17g}], distance [{:.17g} {:.17g}], reference {} {} {}: "
      "axes {:.17g}, exponents {:.17g}, taper {:.17g}, translation {:.17g}, quaternion {:.17g}, at {:.17g}",
      found.unique ? "the only" : "a", found.point[0].lo, found.point[0].hi, found.point[1].lo, found.point[1].hi,
      found.point[2].lo, found.point[2].hi, found.distance.lo, found.distance.hi, text(reference[0]),
      text(reference[1]), text(reference[2]), fmt::join(axes, " "), fmt::join(exponents, " "), taper,
      fmt::join(primitive.pose.translation, " "), fmt::join(primitive.pose.quaternion, " "), fmt::join(x, " "));
}

/// What is said about one family of points on one side of the surface.
struct FamilyOfBoxes {
  std::size_t queries = 0;
  std::size_t unique = 0;
  std::size_t loose_references = 0;  ///< of all, also where many points are closest and a reference has none to find
  std::size_t untested = 0;          ///< of those, where one point is said to be the only one
  double widest_point = 0.0;         ///< of unique ones, in units of PosedSolid::magnitude
  double widest_normal = 0.0;
};

class ClosestPointTally {
 public:
  void add(const Primitive& primitive, const PosedSolid& solid, const RandomPoint& query, const ClosestPoint& found) {
    const bool beside = found.distance.lo <= 0.0 && found.distance.hi >= 0.0;
    ReferencePoint reference = solid.closest_point(query.point);
    const auto tiny = [&] { return reference.radius < ldexp(solid.magnitude(query.point), -60); };
    // Where the answer is nearer than what the reference found, the reference may have missed a nearer point.
    const auto farther = [&] { return reference.distance.upper < Real(found.distance.lo); };
    if (!reference.distance.upper_is_proven && !beside && (farther() || !tiny())) {
      reference = solid.closest_point(query.point, Search::thorough);
    }
    const bool usable = tiny() && (reference.distance.upper_is_proven || !farther());
    const Vector apart = difference(widened(query.point), reference.centre);
    const Real length_apart = length(apart);
    const Real sign = reference.distance.lower > 0 ? 1 : -1;
    const Vector normal = scaled<Real>(apart, sign / length_apart);
    const Real error = 2 * reference.radius / length_apart;
    const std::lock_guard lock(mutex_);
    FamilyOfBoxes& family = families_[fmt::format("{}, {}", to_string(query.family), sign > 0 ? "outside" : "inside")];
    ++family.queries;
    if (!usable) {
      ++family.loose_references;
      if (found.unique) ++family.untested;
      return;
    }
    if (!meets(found.point, reference.centre, reference.radius) || !meets(found.normal, normal, error)) {
      ADD_FAILURE() << described(primitive, query.point, found, reference.centre);
    }
    if (!found.unique) return;
    ++family.unique;
    family.widest_point =
        std::max(family.widest_point, widest(found.point) / solid.magnitude(query.point).convert_to<double>());
    family.widest_normal = std::max(family.widest_normal, widest(found.normal));
  }

  void print_and_expect_useful() const {
    std::size_t queries = 0;
    std::size_t untested = 0;
    fmt::print("{:<28}{:>9}{:>9}{:>18}{:>10}{:>14}{:>15}\n", "closest points", "cases", "unique", "loose references",
               "untested", "widest point", "widest normal");
    for (const auto& [name, family] : families_) {
      fmt::print("{:<28}{:>9}{:>9}{:>18}{:>10}{:>14.3g}{:>15.3g}\n", name, family.queries, family.unique,
                 family.loose_references, family.untested, family.widest_point, family.widest_normal);
      queries += family.queries;
      untested += family.untested;
      if (name.ends_with("outside")) {
        EXPECT_EQ(family.unique + family.loose_references, family.queries) << name;
      }
    }
    EXPECT_LE(untested, 1 + queries / 100) << "the reference itself failed to converge";
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, FamilyOfBoxes> families_;
};

std::size_t solids_of(std::size_t queries) {
  return std::max<std::size_t>(1, queries / queries_a_solid);
}

TEST(ClosestPointSoundnessTest, BoxesContainTheReference) {
  ClosestPointTally tally;
  in_parallel(solids_of(requested_count("VERISQ_SOUNDNESS_CASES", usual_queries)), [&](std::size_t index) {
    RandomCases random(index);
    const Primitive primitive = random.solid();
    const PosedSolid solid(primitive.superquadric, primitive.pose);
    const SignedDistance distance(Model{"", {primitive}});
    const double size = std::ranges::max(primitive.superquadric.semi_axes);
    for (std::size_t i = 0; i < queries_a_solid; ++i) {
      const RandomPoint query = random.point(primitive);
      const bool on_surface = query.family == PointFamily::on_boundary;  // where the reference knows no direction
      if (!on_surface) tally.add(primitive, solid, query, distance.closest_point(query.point, 1e-6 * size));
    }
  });
  tally.print_and_expect_useful();
}

TEST(ClosestPointSoundnessTest, BoxesContainKnownPointsOfTaperedSolids) {
  std::mutex mutex;
  in_parallel(solids_of(requested_count("VERISQ_SOUNDNESS_CASES", usual_queries)), [&](std::size_t index) {
    std::mt19937_64 random(index);
    const Primitive primitive = random_tapered(random, 19.0);
    const TaperedSolid solid(primitive);
    const SignedDistance distance(Model{"", {primitive}});
    const double size = std::ranges::max(primitive.superquadric.semi_axes);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < queries_a_solid; ++i) {
      const Triple<double> direction{normal(random), normal(random), normal(random)};
      const double apart = size * std::exp(std::uniform_real_distribution(std::log(1e-4), std::log(10.0))(random));
      const KnownContact contact = solid.contact(direction, apart);
      const Vector foot = solid.surface(direction).point;
      const ClosestPoint found = distance.closest_point(contact.query, 1e-6 * size);
      const Real radius = sqrt(contact.upper * contact.upper - contact.lower * contact.lower);
      const std::lock_guard lock(mutex);
      EXPECT_TRUE(found.unique && meets(found.point, foot, radius)) << described(primitive, contact.query, found, foot);
      EXPECT_LT(widest(found.point), 1e-6 * size) << described(primitive, contact.query, found, foot);
    }
  });
}

}  // namespace
}  // namespace verisq::oracle
