/// Fits of implants with bends and set operations: distances that the search climbs by, and what it finds.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/primitive_projection.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/files.hpp"
#include "verisq/fit.hpp"

namespace verisq {
namespace {

using Eigen::Vector3d;
using fit_search::Candidate;
using fit_search::CandidateSpace;
using fit_search::Evaluation;
using fit_search::Parameters;
using fit_search::PointDistance;

constexpr double kGap = 0.5;

Vector3d vector(const Point& p) {
  return {p[0], p[1], p[2]};
}

Point point(const Vector3d& v) {
  return {v[0], v[1], v[2]};
}

/// An arm bent by 36 degrees and a barb across it: no symmetry.
Model bent_hook() {
  return {"mm",
          {{"arm", {{4.0, 5.0, 20.0}, {0.7, 0.9}, 1.5}, {}, Bend{0.0157, 30.0}},
           {"barb", {{12.0, 4.0, 5.0}, {0.9, 0.6}}, {{9.0, 1.0, 14.0}, {0.98, 0.1, 0.1, 0.1}}}},
          {}};
}

/// A hemispherical shell with a hole and a peg: what cups are made of.
Model cup() {
  const auto leaf = [](std::uint32_t primitive) { return SetExpression{.primitive = primitive}; };
  return {"mm",
          {{"shell", {{20.0, 20.0, 20.0}, {1.0, 1.0}}, {}},
           {"half", {{30.0, 30.0, 12.0}, {0.1, 0.1}}, {{0.0, 0.0, -10.0}}},
           {"hollow", {{17.0, 17.0, 17.0}, {1.0, 1.0}}, {}},
           {"hole", {{3.0, 2.0, 10.0}, {0.5, 1.0}}, {{5.0, 3.0, -15.0}}},
           {"peg", {{2.0, 3.0, 4.0}, {0.5, 1.0}}, {{-14.0, 0.0, -15.0}, {0.9, 0.0, 0.4, 0.0}}}},
          SetExpression{
              {{{{{leaf(0), leaf(1)}, SetOperation::intersect}, leaf(2), leaf(3)}, SetOperation::subtract}, leaf(4)},
              SetOperation::unite}};
}

std::vector<PointDistance> distances(const Model& model, const std::vector<Point>& points) {
  const std::vector<double> weights(points.size(), 1.0);
  const CandidateSpace space(model, {{}, 0.0, 0.0});
  std::vector<PointDistance> found;
  fit_search::host_candidate_evaluator(points, weights)->distances(space.candidate(space.start()), found);
  return found;
}

/// Points that are proven to be about `gap` from the model: random ones that walk there.
Cavity offset_cavity(const Model& model, double gap, std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(-1.5, 1.5);
  const double radius = bounding_radius(model);
  const SignedDistance proof(model);
  Cavity cavity{{}, {{"all", 1.0}}, {}};
  while (cavity.points.size() < count) {
    std::vector<Point> points(4 * count);
    for (Point& p : points) p = {radius * anywhere(random), radius * anywhere(random), radius * anywhere(random)};
    for (int step = 0; step < 20; ++step) {
      const std::vector<PointDistance> found = distances(model, points);
      for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = point(vector(points[i]) + (gap - found[i].distance) * vector(found[i].normal));
    }
    for (const Point& p : points) {
      const Enclosure found = proof(p, 1e-7);
      if (std::fabs(found.lo - gap) < 1e-5 && std::fabs(found.hi - gap) < 1e-5 && cavity.points.size() < count)
        cavity.points.push_back(p);
    }
  }
  cavity.area_of.assign(cavity.points.size(), 0);
  return cavity;
}

/// Strong and weak bends, tapered or not, towards any side.
Primitive random_bent(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto between = [&](double lo, double hi) { return lo + (hi - lo) * uniform(random); };
  const Superquadric solid{{between(1.0, 4.0), between(1.0, 4.0), between(3.0, 20.0)},
                           {between(0.3, 1.3), between(0.3, 1.3)},
                           uniform(random) < 0.5 ? 1.0 : between(0.5, 2.0)};
  const double most = std::min(0.4 / (2.0 * (solid.semi_axes[0] + solid.semi_axes[1])), 1.2 / solid.semi_axes[2]);
  return {"", solid, {}, Bend{(uniform(random) < 0.5 ? -1.0 : 1.0) * most * uniform(random), between(-180.0, 180.0)}};
}

TEST(BentProjection, DistancesAreThoseOfTheProof) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  int outside = 0;
  int inside = 0;
  int elsewhere = 0;
  for (int i = 0; i < 400; ++i) {
    const Primitive primitive = random_bent(random);
    const fit_search::BentProjection projection(primitive.superquadric, *primitive.bend);
    const double size = primitive.superquadric.semi_axes[2];
    const Vector3d q = fit_search::BentProjection(primitive.superquadric, *primitive.bend)
                           .image({3.5 * anywhere(random), 3.5 * anywhere(random), 1.2 * size * anywhere(random)});
    const fit_search::Projection found = projection(q);
    const Enclosure exact = SignedDistance({"", {primitive}, {}})(point(q), 1e-7 * size);
    EXPECT_LE(projection.lower_bound(q), exact.hi) << i;
    EXPECT_NEAR(found.normal.norm(), 1.0, 1e-9);
    (exact.lo >= 0.0 ? outside : inside) += 1;
    // Nothing is nearer; now and then a locally shortest way is taken.
    EXPECT_GE(std::fabs(found.distance), std::fabs(exact.lo) - std::fabs(exact.width()) - 1e-6 * size) << i;
    if (std::fabs(found.distance - exact.lo) > exact.width() + 1e-6 * size) ++elsewhere;
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(inside, 60);
  EXPECT_LE(elsewhere, 8);
}

TEST(BentProjection, NormalsAndSizesAreDerivatives) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Primitive primitive = random_bent(random);
    const auto at = [&](const Superquadric& solid, const Vector3d& q) {
      return fit_search::BentProjection(solid, *primitive.bend)(q).distance;
    };
    const Superquadric& solid = primitive.superquadric;
    const Vector3d q(7.0 * anywhere(random), 7.0 * anywhere(random), solid.semi_axes[2] * anywhere(random));
    const fit_search::BentProjection projection(solid, *primitive.bend);
    const fit_search::Projection found = projection(q);
    if (found.distance < 0.05) continue;
    const Vector3d by_size = projection.size_gradient(found);
    const double h = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = h * Vector3d::Unit(axis);
      EXPECT_NEAR((at(solid, q + step) - at(solid, q - step)) / (2.0 * h), found.normal[axis], 1e-4) << i;
      Superquadric larger = solid;
      Superquadric smaller = solid;
      larger.semi_axes[static_cast<std::size_t>(axis)] += h;
      smaller.semi_axes[static_cast<std::size_t>(axis)] -= h;
      EXPECT_NEAR((at(larger, q) - at(smaller, q)) / (2.0 * h), by_size[axis], 1e-3) << i;
    }
  }
}

/// The sign is the set's, and near a face the distance; nothing is nearer than told.
TEST(HostEvaluator, DistancesToSetsHaveTheirSign) {
  const Model model = cup();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> anywhere(-26.0, 26.0);
  std::vector<Point> points(500);
  for (Point& p : points) p = {anywhere(random), anywhere(random), anywhere(random)};
  const std::vector<PointDistance> found = distances(model, points);
  const SignedDistance proof(model);
  int inside = 0;
  int exact = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Enclosure e = proof(points[i], 1e-5);
    const bool decided = e.lo > 0.0 || e.hi < 0.0;
    EXPECT_TRUE(!decided || (found[i].distance < 0.0) == (e.hi < 0.0)) << i;
    EXPECT_LE(std::fabs(found[i].distance), std::max(std::fabs(e.lo), std::fabs(e.hi)) + 1e-6) << i;
    if (e.hi < 0.0) ++inside;
    if (found[i].distance >= e.lo - 1e-4 && found[i].distance <= e.hi + 1e-4) ++exact;
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(exact, 250);
}

double objective(fit_search::CandidateEvaluator& evaluator, const CandidateSpace& space, const Parameters& at,
                 const Fitness& fitness) {
  const Candidate candidate = space.candidate(at);
  std::vector<Evaluation> evaluations;
  evaluator.evaluate({&candidate, 1}, fitness, {}, 1, evaluations);
  return evaluations.front().objective;
}

class SolidFit : public ::testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] static Model implant() { return GetParam() ? bent_hook() : cup(); }
};

TEST_P(SolidFit, GradientIsThatOfTheObjective) {
  const Cavity cavity = offset_cavity(implant(), kGap, 60);
  const std::vector<double> weights(cavity.points.size(), 0.7);
  const auto evaluator = fit_search::host_candidate_evaluator(cavity.points, weights);
  const CandidateSpace space(implant(), {{{1.0, 2.0, 0.5}, {0.99, 0.05, -0.1, 0.1}}, 20.0, 60.0});
  const Fitness fitness = cemented(kGap, 2.0);
  const Parameters at{0.3, -0.7, 0.2, 0.4, -0.6, 0.3};
  const Candidate candidate = space.candidate(at);
  std::vector<Evaluation> evaluations;
  evaluator->evaluate({&candidate, 1}, fitness, {}, 1, evaluations);
  const Parameters gradient = space.gradient(at, evaluations[0].pose_gradient, evaluations[0].size_gradient);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double h = 1e-6;
    Parameters above = at;
    Parameters below = at;
    above[i] += h;
    below[i] -= h;
    const double slope =
        (objective(*evaluator, space, above, fitness) - objective(*evaluator, space, below, fitness)) / (2.0 * h);
    EXPECT_NEAR(gradient[i], slope, 1e-3 * (1.0 + std::fabs(slope))) << i;
  }
}

/// The cavity was made of the implant: from 8 mm and 17 degrees off it is found again, with its bend and its tree.
TEST_P(SolidFit, FindsImplantsAgain) {
  const Model model = implant();
  const Cavity cavity = offset_cavity(model, kGap, 150);
  FitOptions options{.fitness = cemented(kGap, 0.25),
                     .penetration_limit = 0.0,
                     .range = {{{3.0, -5.0, 5.0}, {0.985, 0.1, -0.1, 0.1}}, 12.0, 30.0}};
  options.samples = 512;
  options.device = "host";
  const UncertainModel exact = model;
  const Fit best = fit({&exact, 1}, cavity, options);
  EXPECT_TRUE(best.within_limit);
  EXPECT_NEAR(best.objective, static_cast<double>(cavity.points.size()),
              0.02 * static_cast<double>(cavity.points.size()));
  ASSERT_EQ(best.model.primitives.size(), model.primitives.size());
  EXPECT_EQ(best.model.csg.has_value(), model.csg.has_value());
  for (std::size_t k = 0; k < model.primitives.size(); ++k) {
    ASSERT_EQ(best.model.primitives[k].bend.has_value(), model.primitives[k].bend.has_value());
    const double curvature = model.primitives[k].bend.value_or(Bend{}).curvature;
    EXPECT_EQ(best.model.primitives[k].bend.value_or(Bend{}).curvature, curvature);
    const Vector3d off =
        vector(best.model.primitives[k].pose.translation) - vector(model.primitives[k].pose.translation);
    EXPECT_LE(off.norm(), 0.1) << k;
  }
  const SignedDistance proof(best.model);
  double sum = 0.0;
  for (const Point& p : cavity.points) {
    const Enclosure found = proof(p, 1e-7);
    EXPECT_GE(found.hi, -1e-6);
    sum += value(options.fitness, std::midpoint(found.lo, found.hi));
  }
  EXPECT_NEAR(best.objective, sum, 1e-3 * sum) << "what is told is what the proof says";
}

INSTANTIATE_TEST_SUITE_P(Implants, SolidFit, ::testing::Bool(),
                         [](const auto& bent) { return bent.param ? "Bent" : "Cut"; });

TEST(SolidFitBound, IsRefused) {
  const UncertainModel bent = bent_hook();
  const Cavity cavity = offset_cavity(bent_hook(), kGap, 5);
  testing::expect_error(
      [&] {
        (void)bound_fit({&bent, 1}, cavity,
                        {.fitness = cemented(kGap, 0.25),
                         .penetration_limit = 0.0,
                         .range = {{}, 1.0, 1.0},
                         .known = 1.0,
                         .gap = 0.1});
      },
      ErrorKind::input, "", "bound: implants[0]: not supported for bent solids: primitives[0].bend");
}

}  // namespace
}  // namespace verisq
