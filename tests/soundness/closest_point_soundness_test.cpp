/// Soundness of closest points: no box misses the closest point, and none that is said to be the only one is not.
///
/// Random solids, poses and points of tests/oracle/random_cases.hpp against MPFR at 200 bits, tapered solids with
/// queries above known points of their surfaces, bent ones with queries above points of theirs, and set operations.
/// VERISQ_SOUNDNESS_CASES sets the number of cases. The full run is
///   VERISQ_SOUNDNESS_CASES=100000 build/release/tests/soundness_test --gtest_filter='ClosestPointSoundness*'
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <map>
#include <mutex>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/reference_distance.hpp"
#include "tests/oracle/solid_escape.hpp"
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

/// The forward formula of verisq/model.hpp, to the letter.
Vector bent(const Vector& local, const Bend& bend) {
  const Real angle = bend.angle_degrees * boost::math::constants::pi<Real>() / 180;
  const Real c = cos(angle);
  const Real s = sin(angle);
  const Real k = bend.curvature;
  const Real r = local[0] * c + local[1] * s;
  const Real across = local[1] * c - local[0] * s;
  const Real R = 1 / k - (1 / k - r) * cos(k * local[2]);
  const Real Z = (1 / k - r) * sin(k * local[2]);
  return {R * c - across * s, R * s + across * c, Z};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A part of the surface of a bent solid, by two coordinates about one of its points.
class BentPatch {
 public:
  BentPatch(const Primitive& primitive, const Vector& local)
      : solid_(primitive.superquadric, primitive.pose), bend_(*primitive.bend), centre_(local) {
    const auto largest = static_cast<std::size_t>(
        std::ranges::max_element(local, [](const Real& a, const Real& b) { return abs(a) < abs(b); }) - local.begin());
    across_ = {(largest + 1) % 3, (largest + 2) % 3};
  }

  [[nodiscard]] Vector operator()(const Real& a, const Real& b) const {
    Vector local = centre_;
    local[across_[0]] += a;
    local[across_[1]] += b;
    return solid_.from_own_frame(bent(scaled<Real>(local, 1 / solid_.norm().gauge(local)), bend_));
  }

 private:
  PosedSolid solid_;
  Bend bend_;
  Vector centre_;
  std::array<std::size_t, 2> across_{};
};

/// The point of the patch that Newton's method finds to be nearest to `x`, and how far its last step went: derivatives
/// are differences in 200 bits.
std::pair<Vector, Real> nearest_on(const BentPatch& patch, const Vector& x, const Real& size) {
  const Real h = ldexp(size, -45);
  Real a = 0;
  Real b = 0;
  Real step = size;
  const auto f = [&](const Real& u, const Real& v) {
    const Vector apart = difference(patch(u, v), x);
    return Real(dot(apart, apart) / 2);
  };
  for (int i = 0; i < 12 && step > ldexp(size, -80); ++i) {
    const Real middle = f(a, b);
    const Real fa = (f(a + h, b) - f(a - h, b)) / (2 * h);
    const Real fb = (f(a, b + h) - f(a, b - h)) / (2 * h);
    const Real faa = (f(a + h, b) - 2 * middle + f(a - h, b)) / (h * h);
    const Real fbb = (f(a, b + h) - 2 * middle + f(a, b - h)) / (h * h);
    const Real fab = (f(a + h, b + h) - f(a + h, b - h) - f(a - h, b + h) + f(a - h, b - h)) / (4 * h * h);
    const Real determinant = faa * fbb - fab * fab;
    const Real da = (fb * fab - fa * fbb) / determinant;
    const Real db = (fa * fab - fb * faa) / determinant;
    a += da;
    b += db;
    step = std::max<Real>(abs(da), abs(db));
  }
  return {patch(a, b), step};
}

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

/// Queries above random points of the surface, along about its normal there: what Newton's method finds about that
/// point lies in the box wherever it is as near as the distance.
TEST(ClosestPointSoundnessTest, BoxesContainPointsOfBentSolids) {
  std::mutex mutex;
  std::size_t queries = 0;
  std::size_t unique = 0;
  std::size_t compared = 0;
  double widest_box = 0.0;
  in_parallel(solids_of(requested_count("VERISQ_SOUNDNESS_CASES", usual_queries)), [&](std::size_t index) {
    RandomSolids solids(index);
    RandomCases random(index);
    const Model model = solids.model(ModelFamily::bent);
    const Primitive& primitive = model.primitives.front();
    const SignedDistance distance(model);
    const double size = std::ranges::max(primitive.superquadric.semi_axes);
    for (std::size_t i = 0; i < queries_a_solid; ++i) {
      const BentPatch patch(primitive, widened(random.boundary_point(primitive.superquadric).point));
      const Real h = ldexp(Real(size), -40);
      const Vector foot = patch(0, 0);
      const Vector u = difference(patch(h, 0), foot);
      const Vector v = difference(patch(0, h), foot);
      const Vector across = cross(u, v);
      const double apart = size * random.log_uniform(1e-4, 3.0) * (random.choice(2) == 0 ? 1.0 : -1.0);
      Point x{};
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = Real(foot[k] + apart * across[k] / length(across)).convert_to<double>();
      const ClosestPoint found = distance.closest_point(x, 1e-2 * size);
      const auto [nearest, last_step] = nearest_on(patch, widened(x), size);
      const Real found_distance = length(difference(nearest, widened(x)));
      const bool outside = found.distance.lo > 0.0;
      const std::lock_guard lock(mutex);
      if (outside) ++queries;
      if (outside && found.unique) {
        ++unique;
        widest_box = std::max(widest_box, widest(found.point) / size);
      }
      // Elsewhere Newton's method went somewhere else, or the foot is not the nearest point.
      if (!outside || !found.unique || !(last_step < ldexp(Real(size), -60)) ||
          found_distance > Real(found.distance.hi))
        continue;
      ++compared;
      EXPECT_TRUE(meets(found.point, nearest, ldexp(Real(size), -58)) && found_distance >= Real(found.distance.lo))
          << described(primitive, x, found, nearest) << ", bend " << primitive.bend->curvature << " "
          << primitive.bend->angle_degrees;
    }
  });
  fmt::print("bent: {} queries outside, {} unique, {} compared; widest box {:.3g}\n", queries, unique, compared,
             widest_box);
  EXPECT_GT(unique, queries / 4);
  EXPECT_GT(compared, unique / 4);
}

/// Edges and points have other directions into the solid than against the normal.
bool is_smooth(const Model& model) {
  constexpr double sharpest = 1.9;
  return std::ranges::all_of(model.primitives, [](const Primitive& primitive) {
    return std::ranges::max(primitive.superquadric.exponents) < sharpest;
  });
}

/// Whether a little from the closest point, towards the query, is as the query is, in the solid or not; where the solid
/// is smooth, also whether what lies to the other side is not.
bool parts_the_solid(const ExactMembership& exact, const ClosestPoint& found, double little, bool smooth) {
  const auto along = [&](double step) {
    Vector x;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = (Real(found.point[k].lo) + Real(found.point[k].hi)) / 2 +
             step * (Real(found.normal[k].lo) + Real(found.normal[k].hi)) / 2;
    }
    return x;
  };
  const bool out = exact(along(little)) == Membership::outside;
  const bool in = exact(along(-little)) == Membership::inside;
  return smooth ? out && in : (found.distance.hi < 0.0 || out) && (found.distance.lo > 0.0 || in);
}

/// Random trees and shells: the distance is that of the reference, and the surface is where it is said to be.
TEST(ClosestPointSoundnessTest, PointsOfSetOperationsLieOnTheSurface) {
  constexpr std::array families{ModelFamily::plain_csg, ModelFamily::bent_csg, ModelFamily::thin_difference};
  constexpr std::size_t cubes = 1000;
  constexpr std::size_t share_of_cases = 10;  // the reference takes so much longer
  std::mutex mutex;
  std::size_t queries = 0;
  std::size_t unique = 0;
  std::size_t inside = 0;
  const std::size_t models =
      std::max(families.size(), solids_of(requested_count("VERISQ_SOUNDNESS_CASES", usual_queries) / share_of_cases));
  in_parallel(models, [&](std::size_t index) {
    RandomSolids solids(5000 + index);
    const Model model = solids.model(families[index % families.size()]);
    const SolidReference reference(model);
    if (reference.points_of_solid().empty()) return;  // then there is no distance
    const SignedDistance distance(model);
    for (std::size_t i = 0; i < queries_a_solid; ++i) {
      const Point x = solids.point(reference.placed(), solid_point_families[i % solid_point_families.size()]);
      const ClosestPoint found = distance.closest_point(x, 1e-2 * reference.size());
      const SolidFacts facts = reference.facts(x, cubes);
      const std::lock_guard lock(mutex);
      ++queries;
      if (const auto evidence = escape(found.distance, model, x, facts.lower, facts.upper)) ADD_FAILURE() << *evidence;
      if (!found.unique) continue;
      ++unique;
      inside += found.distance.hi < 0.0 ? 1 : 0;
      const double little = 1e3 * widest(found.point) + 1e-13 * reference.size();
      EXPECT_TRUE(parts_the_solid(reference.exact(), found, little, is_smooth(model)))
          << model_json(model) << fmt::format(" at {}", x);
    }
  });
  fmt::print("set operations: {} queries, {} unique, {} of them inside\n", queries, unique, inside);
  EXPECT_GT(unique, queries / 4);
  EXPECT_GT(inside, unique / 50);
}

}  // namespace
}  // namespace verisq::oracle
