/// Certificates of deviations prove what was found, and never what is false. VERISQ_FORGED_DEVIATIONS says how many
/// changes of each case are tried.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/threads/parallel.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forged_samples.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"

namespace verisq::testing {
namespace {

using oracle::forge;
using oracle::moved;
using oracle::RandomCases;

const std::vector<double> percentiles{50.0, 95.0};

struct Answer {
  Model model;
  Mesh mesh;
  double tolerance;  ///< relative
  Deviation found;
  CertifiedDeviation certified;
};

ProvenDeviation proven_of(const Model& model, const Mesh& mesh, const DeviationCertificate& certificate) {
  return DeviationChecker(model)(
      mesh, certificate,
      {.percentiles = percentiles, .check = {.in_parallel = [](auto count, auto work) { in_parallel(count, work); }}});
}

Answer certified(const Model& model, const Mesh& mesh, double relative_tolerance = 0.05) {
  DeviationOptions options;
  options.device = "host";
  options.from_model = false;
  options.percentiles = percentiles;
  options.relative_tolerance = relative_tolerance;
  Deviation found = deviation(model, mesh, options);
  CertifiedDeviation proof = certified_deviation(model, mesh, found, options);
  return {model, mesh, relative_tolerance, std::move(found), std::move(proof)};
}

Primitive superquadric(const std::array<double, 3>& axes, const std::array<double, 2>& exponents, const Point& centre) {
  return {"", {axes, exponents}, {centre, {0.9, 0.2, -0.3, 0.1}}, {}};
}

/// A ball, one convex solid, a union, a bent solid, a difference and a mesh, each in a torus that lies about them.
const std::vector<Answer>& answers() {
  const Mesh torus = torus_mesh(3.0, 1.0, 6, 4);
  const Primitive soap = superquadric({2.0, 1.6, 1.0}, {0.4, 0.7}, {0.1, 0.2, -0.1});
  const Primitive side = superquadric({1.0, 1.0, 1.0}, {1.0, 1.0}, {2.5, 0.0, 0.2});
  Primitive bent = superquadric({0.6, 0.5, 2.0}, {0.8, 0.9}, {0.3, 0.0, 0.0});
  bent.bend = Bend{0.2, 30.0};
  const SetExpression difference{{{.primitive = 0}, {.primitive = 1}}, SetOperation::subtract};
  const Pose turned{{0.1, 0.2, -0.1}, {0.9, 0.2, -0.3, 0.1}};
  static const std::vector<Answer> all{certified({"", {superquadric({2, 2, 2}, {1, 1}, {})}}, torus),
                                       certified({"", {soap}}, torus),
                                       certified({"", {soap, side}}, torus, 0.1),
                                       certified({"", {bent, side}}, torus, 0.1),
                                       certified({"", {bent}}, torus, 0.1),
                                       certified({"", {soap, side}, difference}, torus_mesh(3.0, 1.0, 4, 3), 0.3),
                                       certified({"", {mesh_primitive("ball", sphere_mesh(1), turned)}}, torus, 0.1)};
  return all;
}

bool meet(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.hi && b.lo <= a.hi;
}

void expect_true_of(const DistanceSummary& proven, const DistanceStatistics& found) {
  EXPECT_TRUE(meet(proven.largest, found.largest));
  EXPECT_TRUE(meet(proven.mean, *found.mean));
  for (std::size_t i = 0; i < percentiles.size(); ++i) {
    EXPECT_TRUE(meet(proven.percentiles[i], found.percentiles[i]));
  }
}

void expect_true_of(const ProvenDeviation& proven, const Deviation& found) {
  expect_true_of(proven.of_vertices, found.of_vertices);
  if (proven.from_mesh) expect_true_of(*proven.from_mesh, *found.from_mesh);
}

TEST(DeviationCertificateTest, ProvesAboutWhatWasFound) {
  for (const Answer& answer : answers()) {
    const ProvenDeviation& proven = answer.certified.proven;
    ASSERT_TRUE(proven.from_mesh.has_value());
    EXPECT_EQ(proven.unproved_samples, 0U);
    expect_true_of(proven, answer.found);
    EXPECT_LE(proven.from_mesh->largest.width(), 2.0 * answer.tolerance * answer.found.from_mesh->largest.hi);
    EXPECT_LE(proven.from_mesh->mean.width(), 4.0 * answer.tolerance * answer.found.from_mesh->mean->hi);
    const ProvenDeviation again = proven_of(answer.model, answer.mesh, answer.certified.certificate);
    EXPECT_EQ(again.from_mesh->largest, proven.from_mesh->largest);
    EXPECT_EQ(again.from_mesh->mean, proven.from_mesh->mean);
    EXPECT_EQ(again.of_vertices.percentiles, proven.of_vertices.percentiles);
  }
}

/// One triangle above a ball of radius 1: the farthest point is a corner, at √11 - 1.
TEST(DeviationCertificateTest, OfATriangleAboveABall) {
  const Model ball{"", {{"", {{1, 1, 1}, {1, 1}}, {}}}};
  const Mesh triangle{.vertices = {{1, 1, 3}, {-1, 1, 3}, {0, -1, 3}}, .triangles = {{0, 1, 2}}};
  const Answer answer = certified(ball, triangle);
  const DistanceSummary& proven = *answer.certified.proven.from_mesh;
  EXPECT_LE(proven.largest.lo, std::sqrt(11.0) - 1.0);
  EXPECT_GE(proven.largest.hi, std::sqrt(11.0) - 1.0 - 1e-15);
  EXPECT_LE(proven.largest.width(), 0.06 * proven.largest.hi);
  EXPECT_GE(proven.mean.lo, 1.9);
}

/// Across the hollow side of a bend, where the signed distance is not convex: the middle is five times as far away as
/// the corners.
TEST(DeviationCertificateTest, OfATriangleAcrossTheHollowOfABend) {
  Primitive banana{"", {{0.3, 0.3, 2.0}, {1.0, 1.0}}, {}};
  banana.bend = Bend{0.6, 0.0};
  const Mesh across{.vertices = {{0.784, 0.0, 0.909}, {0.784, 0.0, -0.909}, {0.784, 0.02, 0.9}},
                    .triangles = {{0, 1, 2}}};
  const Answer answer = certified({"", {banana}}, across);
  EXPECT_GT(answer.found.from_mesh->largest.lo, 0.45);
  expect_true_of(answer.certified.proven, answer.found);
  DeviationCertificate by_centre = answer.certified.certificate;
  const Point centre = verify::centre({across.vertices[0], across.vertices[1], across.vertices[2]});
  by_centre.triangles[0] = {{PieceProof::centre}, {SignedDistance(answer.model).certified(centre, 1e-6)}};
  expect_true_of(proven_of(answer.model, across, by_centre), answer.found);
}

TEST(DeviationCertificateTest, OfExtremeLengthsThereIsNone) {
  for (const double size : {1e-200, 1e-150, 1e150, 1e300}) {
    const Model ball{"", {superquadric({size, size, size}, {1, 1}, {})}};
    const Mesh mesh{{{4.0 * size, 0, 0}, {0, 4.0 * size, 0}, {0, 0, 4.0 * size}}, {{0, 1, 2}}};
    expect_error([&] { (void)certified(ball, mesh); }, ErrorKind::input,
                 fmt::format("lengths of about {:.0e}", 4.0 * size),
                 ": a certificate of a deviation takes lengths from 1e-144 to 1e144; scale model and mesh");
  }
}

TEST(DeviationCertificateTest, OfACloudItsPointsAreProven) {
  const Model ball{"", {{"", {{1, 1, 1}, {1, 1}}, {}}}};
  const Answer answer = certified(ball, {.vertices = {{2, 0, 0}, {0, 0.5, 0}, {0, 0, -4}}, .triangles = {}});
  EXPECT_FALSE(answer.certified.proven.from_mesh.has_value());
  EXPECT_NEAR(answer.certified.proven.of_vertices.largest.hi, 3.0, 1e-6);
  EXPECT_NEAR(answer.certified.proven.of_vertices.mean.lo, 1.5, 1e-6);
}

void try_claim(const Enclosure& claimed, const Enclosure& proven, oracle::Forgeries& forgeries) {
  const DistanceSummary claims{claimed, claimed, {}};
  const DistanceSummary found{proven, proven, {}};
  forgeries.expect_not_proved(check(claims, found)[0], claimed, "a claim past the truth");
}

/// Beyond what was found, either way.
void try_claims_past(const Enclosure& truth, const Enclosure& proven, oracle::Forgeries& forgeries) {
  try_claim({moved(truth.hi, infinity), infinity}, proven, forgeries);
  if (truth.lo > 0.0) try_claim({0.0, moved(truth.lo, -infinity)}, proven, forgeries);
}

void try_claims_past(const DistanceStatistics& truth, const DistanceSummary& proven, oracle::Forgeries& forgeries) {
  try_claims_past(truth.largest, proven.largest, forgeries);
  try_claims_past(*truth.mean, proven.mean, forgeries);
  for (std::size_t i = 0; i < percentiles.size(); ++i) {
    try_claims_past(truth.percentiles[i], proven.percentiles[i], forgeries);
  }
}

/// Whatever is left out or changed, what is proven is true; the claims past the truth are never proved.
TEST(DeviationCertificateTest, NeverProvesAForgery) {
  oracle::Forgeries forgeries;
  const std::size_t changes = oracle::requested_count("VERISQ_FORGED_DEVIATIONS", 5);
  RandomCases random(5);
  for (const Answer& answer : answers()) {
    const auto change = [&](const auto& make) {
      DeviationCertificate changed = answer.certified.certificate;
      make(changed);
      const ProvenDeviation proven = proven_of(answer.model, answer.mesh, changed);
      expect_true_of(proven, answer.found);
      try_claims_past(answer.found.of_vertices, proven.of_vertices, forgeries);
      try_claims_past(*answer.found.from_mesh, *proven.from_mesh, forgeries);
    };
    const auto any_of = [&](auto& elements) -> auto& {
      return elements[random.choice(elements.size())];
    };
    change([](DeviationCertificate&) {});
    for (std::size_t k = 0; k < changes; ++k) {
      change([&](DeviationCertificate& of) { forge(any_of(of.vertices), random); });
      change([&](DeviationCertificate& of) {
        for (CertifiedEnclosure& sample : any_of(of.triangles).samples) forge(sample, random);
      });
      change([&](DeviationCertificate& of) { std::swap(any_of(of.triangles), any_of(of.triangles)); });
      change([&](DeviationCertificate& of) { forge(any_of(of.triangles), random); });
    }
  }
  EXPECT_GT(forgeries.told(), 1000U);
}

/// All is told, or nothing: of the rest of the triangle nobody knows.
TEST(DeviationCertificateTest, OfAProofThatIsCutShortNothingIsProvenFromAbove) {
  const Model ball{"", {{"", {{1, 1, 1}, {1, 1}}, {}}}};
  const Mesh triangle{.vertices = {{1, 1, 3}, {-1, 1, 3}, {0, -1, 3}}, .triangles = {{0, 1, 2}}};
  const Answer answer = certified(ball, triangle);
  DeviationCertificate cut = answer.certified.certificate;
  cut.triangles[0].pieces.clear();
  EXPECT_EQ(proven_of(ball, triangle, cut).from_mesh->largest.hi, infinity);
  cut.triangles[0].pieces.assign(100, PieceProof::halved);
  EXPECT_EQ(proven_of(ball, triangle, cut).from_mesh->largest.hi, infinity);
  cut.triangles[0].pieces = {PieceProof::corners, PieceProof::corners};
  EXPECT_EQ(proven_of(ball, triangle, cut).from_mesh->largest.hi, infinity);
}

/// The surface of a model that is a mesh, in its place. Whatever its proof says, what is proven is true.
TEST(MeshSurfaceCertificate, ProvesBothWaysAndNoForgery) {
  const Model ball{"", {mesh_primitive("ball", sphere_mesh(1), {{0.1, 0.2, -0.1}, {0.9, 0.2, -0.3, 0.1}})}};
  const Mesh torus = torus_mesh(3.0, 1.0, 12, 6);
  DeviationOptions options;
  options.device = "host";
  options.percentiles = percentiles;
  options.statistics_of_model = true;
  const Deviation found = deviation(ball, torus, options);
  const CertifiedDeviation certified = certified_deviation(ball, torus, found, options);
  const auto prove = [&](const DeviationCertificate& certificate) {
    return DeviationChecker(ball)(torus, certificate, {.percentiles = percentiles, .statistics_of_model = true});
  };
  const auto expect_true = [&](const ProvenDeviation& proven) {
    EXPECT_TRUE(meet(*proven.from_model, found.from_model->largest));
    EXPECT_TRUE(meet(*proven.hausdorff, *found.hausdorff));
    EXPECT_TRUE(meet(proven.statistics_from_model->mean, *found.from_model->mean));
    for (std::size_t i = 0; i < percentiles.size(); ++i)
      EXPECT_TRUE(meet(proven.statistics_from_model->percentiles[i], found.from_model->percentiles[i]));
  };
  const ProvenDeviation proven = prove(certified.certificate);
  expect_true(proven);
  EXPECT_LE(proven.from_model->width(), 0.1 * found.from_model->largest.hi);
  EXPECT_LE(proven.statistics_from_model->mean.width(), 0.2 * found.from_model->mean->hi);
  RandomCases random(7);
  for (int k = 0; k < 50; ++k) {
    DeviationCertificate changed = certified.certificate;
    std::vector<TriangleProof>& triangles = changed.surface->triangles;
    forge(triangles[random.choice(triangles.size())], random);
    std::swap(triangles[random.choice(triangles.size())], triangles[random.choice(triangles.size())]);
    for (CertifiedEnclosure& sample : triangles[random.choice(triangles.size())].samples) forge(sample, random);
    expect_true(prove(changed));
  }
  DeviationCertificate cut = certified.certificate;
  cut.surface->triangles.pop_back();
  EXPECT_EQ(prove(cut).from_model, (Enclosure{0.0, infinity})) << "a triangle is missing";
  cut.surface->triangles.clear();
  EXPECT_EQ(prove(cut).hausdorff->hi, infinity);
}

}  // namespace
}  // namespace verisq::testing
