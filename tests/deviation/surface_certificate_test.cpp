/// Certificates of how far a model's surface lies from a mesh prove what was found, and never what is false.
/// VERISQ_FORGED_DEVIATIONS says how many changes of each kind are tried in each case.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "tests/deviation/brute_force.hpp"
#include "tests/deviation/surface_scenes.hpp"
#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/search/model_distances.hpp"
#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"

namespace verisq::testing {
namespace {

using oracle::RandomCases;
using oracle::with_wrong_digit;

struct Answer {
  Model model;
  Mesh mesh;
  double relative_tolerance;
  Enclosure found;
  SurfaceProof proof;
};

/// The mesh's part of the certificate claims nothing, so that the surface alone is checked.
Enclosure proven_of(const Model& model, const Mesh& mesh, const SurfaceProof& proof) {
  const DeviationCertificate certificate{
      .vertices = std::vector<CertifiedEnclosure>(mesh.vertices.size(), {{-infinity, infinity}, {}}),
      .triangles = std::vector<TriangleProof>(mesh.triangles.size(), {{PieceProof::corners}, {}}),
      .surface = proof};
  const DeviationChecker checker(model);
  return *checker(mesh, certificate,
                  {.check = {.in_parallel = [](auto count, auto work) { in_parallel(count, work); }}})
              .from_model;
}

DeviationOptions options_of(double relative_tolerance) {
  DeviationOptions options;
  options.device = "host";
  options.relative_tolerance = relative_tolerance;
  options.statistics_of_surface = false;
  return options;
}

/// What `deviation` finds of the model's surface, without what it finds of the mesh.
Deviation search(const Model& model, const Mesh& mesh, double relative_tolerance) {
  const SignedDistance signed_distance(model);
  const double tolerance = is_union_of_convex(model) ? 1e-6 : 0.02;
  const verify::DeviationSearch search{
      .to_model =
          [&](std::span<const Point> points, std::span<Enclosure> rows) {
            in_parallel(points.size(), [&](std::size_t i) { rows[i] = signed_distance(points[i], tolerance); });
            return true;
          },
      .allowed = [&](double size) { return relative_tolerance * size; },
      .in_parallel = [](std::size_t count, const auto& work) { in_parallel(count, work); },
      .ended = [] { return false; },
      .progress = [](double) {}};
  const auto found = verify::farthest_of_model(model, verify::TriangleTree(verify::triangles_of(mesh)), search);
  Deviation result;
  result.from_model = DistanceStatistics{found.distance, found.where, {}, {}};
  return result;
}

Answer certified(const Model& model, const Mesh& mesh, double relative_tolerance) {
  const DeviationOptions options = options_of(relative_tolerance);
  const Deviation found = search(model, mesh, relative_tolerance);
  const SeenInterruption never(options.interrupted);
  constexpr std::size_t bytes = 10'000'000;
  const CertifiedSurface surface = certified_surface(model, mesh, found, options, bytes, never, [](double) {});
  return {model, mesh, relative_tolerance, found.from_model->largest, surface.proof.value()};
}

/// A ball and a point; one convex solid, tapered or bent; unions, of which what is within another primitive is far from
/// the mesh; a difference and an intersection.
const std::vector<Answer>& answers() {
  const Mesh torus = torus_mesh(3.0, 1.0, 6, 4);
  const SurfaceScene scene;
  const auto& [soap, side, sharp, bent, difference, intersection] = scene;
  const Primitive within = superquadric({0.4, 0.3, 1.0}, {0.9, 1.1}, {0.0, 0.2, -0.1});
  const Primitive in_bent = superquadric({0.2, 0.2, 0.6}, {1.0, 1.0}, {0.3, 0.0, 0.0});
  const Mesh points_of_soap{.vertices = surface_mesh(soap, 8).vertices, .triangles = {}};
  static const std::vector<Answer> all{
      certified({"", {superquadric({1, 1, 1}, {1, 1}, {})}}, {.vertices = {{3.0, 0.0, 0.0}}, .triangles = {}}, 1e-4),
      certified({"", {soap}}, surface_mesh(soap, 6), 0.05),
      certified({"", {sharp}}, torus, 0.05),
      certified({"", {bent}}, torus, 0.05),
      certified({"", {soap, within}}, surface_mesh(soap, 8), 0.1),
      certified({"", {soap, side, sharp}}, torus, 0.05),
      certified({"", {bent, in_bent}}, surface_mesh(bent, 8), 0.2),
      certified({"", {soap, side}, difference}, points_of_soap, 0.2),
      certified({"", {soap, side}, intersection}, points_of_soap, 0.2)};
  return all;
}

/// The unions and the difference of which not all of the primitives' surfaces is boundary.
constexpr std::array with_hidden_parts{4U, 6U, 7U};

Long distance_to(const Mesh& mesh, const Point& x) {
  if (!mesh.triangles.empty()) return distance_to_mesh(x, mesh);
  Long nearest = HUGE_VALL;
  for (const Point& p : mesh.vertices) nearest = std::min(nearest, distance_to_triangle(x, {p, p, p}));
  return nearest;
}

/// By dense samples: the truth is no less. A point that is not of the boundary has one as near as that is.
double sampled(const Model& model, const Mesh& mesh, int steps) {
  const SignedDistance signed_distance(model);
  const bool is_fast = is_union_of_convex(model);  // others are searched for
  const double tolerance = is_fast ? 1e-9 : 0.02;
  if (!is_fast) steps = std::min(steps, 6);
  const Long half = std::numbers::pi_v<Long> / 2;
  Long farthest = 0;
  for (const Primitive& primitive : model.primitives) {
    for (int n = 0; n < (2 * steps + 1) * 4 * steps; ++n) {
      const int row = n / (4 * steps) - steps;
      const Point x = surface_point(primitive, half * row / steps, half * (n % (4 * steps)) / steps);
      const Long distance = distance_to(mesh, x);
      if (distance <= farthest) continue;
      const Enclosure to_model = signed_distance(x, tolerance);
      const Long off = std::max(std::abs(to_model.lo), std::abs(to_model.hi));
      farthest = std::max(farthest, distance - off - 1e-12L);
    }
  }
  return static_cast<double>(farthest);
}

/// Of each answer what the largest distance is at least, and at most. From a point at 3 the unit ball's antipode is the
/// farthest, at 4.
const std::vector<Enclosure>& truths() {
  static const std::vector<Enclosure> all = [] {
    std::vector<Enclosure> bounds;
    for (const Answer& answer : answers())
      bounds.push_back({std::max(answer.found.lo, sampled(answer.model, answer.mesh, 24)), answer.found.hi});
    bounds[0] = {4.0, 4.0};
    return bounds;
  }();
  return all;
}

TEST(SurfaceCertificateTest, ProvesAboutWhatWasFound) {
  for (std::size_t i = 0; i < answers().size(); ++i) {
    const Answer& answer = answers()[i];
    const Enclosure proven = proven_of(answer.model, answer.mesh, answer.proof);
    EXPECT_GE(proven.hi, truths()[i].lo) << i;
    EXPECT_LE(proven.lo, truths()[i].hi) << i;
    EXPECT_LE(proven.width(), 1.5 * answer.relative_tolerance * answer.found.hi) << i;
  }
}

TEST(SurfaceCertificateTest, WhatIsNoBoundaryDoesNotCount) {
  for (const std::size_t i : with_hidden_parts) {
    const Answer& answer = answers()[i];
    EXPECT_FALSE(answer.proof.cover.off.empty()) << i;
    SurfaceProof all_of_it = answer.proof;
    for (std::vector<PatchProof>& patches : all_of_it.cover.patches)
      std::ranges::replace(patches, PatchProof::off, PatchProof::near);
    EXPECT_GT(proven_of(answer.model, answer.mesh, all_of_it).hi, answer.proof.within) << i;
  }
}

TEST(SurfaceCertificateTest, OfBothWaysTheLargerDistanceIsProven) {
  const Answer& answer = answers()[1];
  const DeviationOptions options = options_of(0.5);
  const Deviation found = deviation(answer.model, answer.mesh, options);
  const CertifiedDeviation certified = certified_deviation(answer.model, answer.mesh, found, options);
  const ProvenDeviation& proven = certified.proven;
  EXPECT_EQ(certified.without_surface, "");
  EXPECT_EQ(proven.unproved_samples, 0U);
  EXPECT_EQ(*proven.from_model, proven_of(answer.model, answer.mesh, *certified.certificate.surface));
  EXPECT_EQ(proven.hausdorff->lo, std::max(proven.from_model->lo, proven.from_mesh->largest.lo));
  EXPECT_EQ(proven.hausdorff->hi, std::max(proven.from_model->hi, proven.from_mesh->largest.hi));
}

/// What has no room, or is not found, is left out, and why is said.
TEST(SurfaceCertificateTest, WhatCannotBeProvenIsNotClaimed) {
  const Answer& answer = answers()[0];
  const DeviationOptions options = options_of(0.1);
  Deviation found = deviation(answer.model, answer.mesh, options);
  const CertifiedDeviation too_large = certified_deviation(answer.model, answer.mesh, found, options, 20);
  EXPECT_FALSE(too_large.certificate.surface.has_value());
  EXPECT_FALSE(too_large.proven.from_model.has_value());
  EXPECT_FALSE(too_large.proven.hausdorff.has_value());
  EXPECT_NE(too_large.without_surface, "");
  found.from_model->largest.hi = infinity;
  const CertifiedDeviation unbounded = certified_deviation(answer.model, answer.mesh, found, options);
  EXPECT_FALSE(unbounded.proven.from_model.has_value());
  EXPECT_NE(unbounded.without_surface, "");
}

/// The mesh has lost a half.
TEST(SurfaceCertificateTest, OfAnotherMeshNoMoreIsProvenThanIsTrue) {
  const Answer& answer = answers()[1];
  Mesh fewer = answer.mesh;
  std::erase_if(fewer.triangles, [&](const auto& triangle) { return answer.mesh.vertices[triangle[0]][0] > 0.0; });
  const Enclosure proven = proven_of(answer.model, fewer, answer.proof);
  EXPECT_GE(proven.hi, sampled(answer.model, fewer, 12));
  EXPECT_GT(proven.hi, 2.0 * answer.found.hi);
}

TEST(SurfaceCertificateTest, OfAProofThatIsCutShortNothingIsProvenFromAbove) {
  const Answer& answer = answers()[4];
  const auto upper_end_of = [&](const auto& change) {
    SurfaceProof changed = answer.proof;
    change(changed);
    return proven_of(answer.model, answer.mesh, changed).hi;
  };
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches.clear(); }), infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches.pop_back(); }), infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches[1].clear(); }), infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches[1].pop_back(); }), infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches[1].push_back(PatchProof::near); }), infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.patches[0].assign(100, PatchProof::halved_along); }),
            infinity);
  EXPECT_EQ(upper_end_of([](SurfaceProof& of) { of.cover.off.pop_back(); }), infinity);
}

/// Whose sizes, and what is left out of their surfaces, are others.
TEST(SurfaceCertificateTest, OfALargerModelNoMoreIsProvenThanIsTrue) {
  for (std::size_t i = 1; i < answers().size(); ++i) {
    const Answer& answer = answers()[i];
    Model larger = answer.model;
    for (Primitive& primitive : larger.primitives) primitive.superquadric.semi_axes[2] *= 1.3;
    const Enclosure proven = proven_of(larger, answer.mesh, answer.proof);
    EXPECT_GE(proven.hi, sampled(larger, answer.mesh, 10)) << i;
  }
}

void forge(CertifiedPoint& point, RandomCases& random) {
  const double by = random.log_uniform(1e-12, 1.0) * (random.choice(2) == 0 ? 1.0 : -1.0);
  auto& [distance, certificate] = point.signed_distance;
  switch (random.choice(6)) {
    case 0: point.point[random.choice(3)] += by; break;
    case 1: distance = {distance.lo + by, distance.hi + by}; break;
    case 2: certificate.normals.clear(); break;
    case 3: distance = {-infinity, -1e-300}; break;
    case 4:
      for (Normal& normal : certificate.normals) normal.primitive = static_cast<std::uint32_t>(random.choice(3));
      break;
    default:
      for (Normal& normal : certificate.normals) {
        double& number = normal.vector[random.choice(3)];
        number = with_wrong_digit(number, random);
      }
  }
}

/// A patch is told otherwise than it was, by something that is true of another one.
void forge_patch(SurfaceProof& proof, RandomCases& random) {
  std::vector<PatchProof>& patches = proof.cover.patches[random.choice(proof.cover.patches.size())];
  PatchProof& patch = patches[random.choice(patches.size())];
  patch = static_cast<PatchProof>(random.choice(4));
  if (!proof.cover.off.empty())
    proof.cover.off.insert(proof.cover.off.begin(), proof.cover.off[random.choice(proof.cover.off.size())]);
}

/// A halving is left out, with what follows of its first half: what else there is belongs to other patches then.
void leave_out(SurfaceProof& proof, RandomCases& random) {
  std::vector<PatchProof>& patches = proof.cover.patches[random.choice(proof.cover.patches.size())];
  const auto at = patches.begin() + static_cast<std::ptrdiff_t>(random.choice(patches.size()));
  const auto last = std::min(patches.end(), at + 1 + static_cast<std::ptrdiff_t>(random.choice(8)));
  patches.erase(at, last);
  while (random.choice(3) != 0) patches.push_back(PatchProof::near);
}

void swap_patches(SurfaceProof& proof, RandomCases& random) {
  std::swap(proof.cover.patches[random.choice(proof.cover.patches.size())],
            proof.cover.patches[random.choice(proof.cover.patches.size())]);
  for (std::vector<PatchProof>& patches : proof.cover.patches) {
    std::swap(patches[random.choice(patches.size())], patches[random.choice(patches.size())]);
  }
}

/// Says that all near patches, or a half of them, are off the boundary.
void claim_too_much(SurfaceProof& proof, RandomCases& random) {
  const std::size_t one_of = 1 + random.choice(2);
  for (std::vector<PatchProof>& patches : proof.cover.patches) {
    for (PatchProof& patch : patches) {
      if (patch == PatchProof::near && random.choice(one_of) == 0) {
        patch = PatchProof::off;
        proof.cover.off.push_back(proof.farthest);
      }
    }
  }
}

void forge(SurfaceProof& proof, RandomCases& random, std::size_t kind) {
  switch (kind) {
    case 0: forge(proof.farthest, random); break;
    case 1:
      for (CertifiedPoint& point : proof.cover.off) forge(point, random);
      break;
    case 2: forge_patch(proof, random); break;
    case 3: leave_out(proof, random); break;
    case 4: swap_patches(proof, random); break;
    case 5: proof.within *= random.uniform(0.0, 1.0); break;
    case 6: claim_too_much(proof, random); break;
    default: proof.farthest.point = proof.cover.off.empty() ? Point{9.0, 9.0, 9.0} : proof.cover.off.front().point;
  }
}

constexpr std::size_t kinds = 8;

/// By so much, relative, and a random way past what is true.
void try_claims_past(const Enclosure& truth, const Enclosure& proven, RandomCases& random,
                     oracle::Forgeries& forgeries) {
  for (const double by : {1e-12, random.log_uniform(1e-12, 1.0)}) {
    for (const Enclosure& claimed :
         {Enclosure{truth.hi * (1.0 + by), infinity}, Enclosure{0.0, truth.lo * (1.0 - by)}}) {
      forgeries.expect_not_proved(check(claimed, proven), claimed, "a claim past the truth");
    }
  }
}

/// Whatever is left out or changed, what is proven is true; claims past the truth are never proved.
TEST(SurfaceCertificateTest, NeverProvesAForgery) {
  oracle::Forgeries forgeries;
  const std::size_t changes = oracle::requested_count("VERISQ_FORGED_DEVIATIONS", 5);
  RandomCases random(7);
  for (std::size_t i = 0; i < answers().size(); ++i) {
    const Answer& answer = answers()[i];
    for (std::size_t k = 0; k < changes * kinds; ++k) {
      SurfaceProof changed = answer.proof;
      forge(changed, random, k % kinds);
      // What is proven from above is never less than that: else it would hide what the patches prove.
      if (random.choice(2) == 0) changed.within = 0.0;
      const Enclosure proven = proven_of(answer.model, answer.mesh, changed);
      EXPECT_GE(proven.hi, truths()[i].lo) << i << ", kind " << k % kinds;
      EXPECT_LE(proven.lo, truths()[i].hi) << i << ", kind " << k % kinds;
      try_claims_past(truths()[i], proven, random, forgeries);
    }
  }
  EXPECT_GT(forgeries.told(), 1000U);
}

/// An octant of which all patches are halved so often.
std::vector<PatchProof> evenly_halved(int depth) {
  if (depth == 0) return {PatchProof::near};
  std::vector<PatchProof> patches{depth % 2 == 0 ? PatchProof::halved_along : PatchProof::halved_around};
  const std::vector<PatchProof> half = evenly_halved(depth - 1);
  for (int i = 0; i < 2; ++i) patches.insert(patches.end(), half.begin(), half.end());
  return patches;
}

/// Whole, and more than a checker need follow.
TEST(SurfaceCertificateTest, OfTooManyPatchesNothingIsProvenFromAbove) {
  const Answer& answer = answers()[0];
  SurfaceProof proof = answer.proof;
  proof.cover.patches = {{}};
  for (int octant = 0; octant < 8; ++octant) {
    const std::vector<PatchProof> patches = evenly_halved(octant == 0 ? 19 : 18);
    proof.cover.patches[0].insert(proof.cover.patches[0].end(), patches.begin(), patches.end());
  }
  ASSERT_GT(proof.cover.patches[0].size(), most_patches);
  EXPECT_EQ(proven_of(answer.model, answer.mesh, proof).hi, infinity);
}

/// The corners of the unit ball's first octant lie in a ball of radius 2.5 about (-1, -1, -1), at 2.45 from there, and
/// its middle does not, at 2.73, which is the farthest point of both from a point beyond.
TEST(SurfaceCertificateTest, APatchBulgesBeyondItsCorners) {
  Model model{"", {superquadric({1, 1, 1}, {1, 1}, {}), superquadric({2.5, 2.5, 2.5}, {1, 1}, {-1, -1, -1})}};
  for (Primitive& primitive : model.primitives) primitive.pose.quaternion = {1, 0, 0, 0};
  const Mesh beyond{.vertices = {{-10, -10, -10}}, .triangles = {}};
  SurfaceProof proof{0.0, {{{PatchProof::off}, {}}, {}}, {{}, {{-infinity, infinity}, {}}}};
  for (int octant = 0; octant < 15; ++octant) {
    const std::vector<PatchProof> patches = evenly_halved(8);
    std::vector<PatchProof>& of = proof.cover.patches[octant < 7 ? 0 : 1];
    of.insert(of.end(), patches.begin(), patches.end());
  }
  proof.cover.off.push_back({{-1, -1, -1}, {{-infinity, -2.49}, {{{1, {1, 0, 0}}}, {}}}});
  const double farthest = std::sqrt(3.0) * 10.0 + 1.0;
  EXPECT_GE(proven_of(model, beyond, proof).hi, farthest);
  proof.cover.patches[0].erase(proof.cover.patches[0].begin());
  const std::vector<PatchProof> first = evenly_halved(8);
  proof.cover.patches[0].insert(proof.cover.patches[0].begin(), first.begin(), first.end());
  EXPECT_NEAR(proven_of(model, beyond, proof).hi, farthest, 0.02);
}

/// A point beside a patch whose ball is a little smaller than the patch is no proof.
TEST(SurfaceCertificateTest, APatchIsOffTheBoundaryByALargeEnoughBallAlone) {
  const Answer& answer = answers()[4];
  ASSERT_FALSE(answer.proof.cover.off.empty());
  SurfaceProof changed = answer.proof;
  for (CertifiedPoint& point : changed.cover.off) point.signed_distance.distance.hi *= 0.25;
  const Enclosure proven = proven_of(answer.model, answer.mesh, changed);
  EXPECT_GT(proven.hi, answer.proof.within);
}

}  // namespace
}  // namespace verisq::testing
