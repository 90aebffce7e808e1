/// Certificates of how far a model's surface lies from a mesh by area, and of how much of it is in contact, prove what
/// dense samples say, and never what is false. VERISQ_FORGED_SURFACES says how many changes of each case are tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "tests/deviation/sampled_surface.hpp"
#include "tests/deviation/surface_scenes.hpp"
#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/search/model_distances.hpp"
#include "verisq/deviation.hpp"

namespace verisq::testing {
namespace {

using oracle::moved;
using oracle::RandomCases;

constexpr std::array percents{50.0, 90.0};

const CheckOptions& by_all_threads() {
  static const CheckOptions options{.in_parallel = [](auto count, auto work) { in_parallel(count, work); }};
  return options;
}

/// The mesh's part of the certificate claims nothing, so that the surface alone is checked.
ProvenDeviation proven_deviation(const Model& model, const Mesh& mesh, const SurfaceCover& cover) {
  const DeviationCertificate certificate{
      .vertices = std::vector<CertifiedEnclosure>(mesh.vertices.size(), {{-infinity, infinity}, {}}),
      .triangles = std::vector<TriangleProof>(mesh.triangles.size(), {{PieceProof::corners}, {}}),
      .surface = SurfaceProof{0.0, cover, {{}, {{-infinity, infinity}, {}}}}};
  return DeviationChecker(model)(mesh, certificate,
                                 {.percentiles = percents, .statistics_of_model = true, .check = by_all_threads()});
}

AreaStatistics proven_statistics(const Model& model, const Mesh& mesh, const SurfaceCover& cover) {
  return *proven_deviation(model, mesh, cover).statistics_from_model;
}

AreaWithin proven_contact(const Model& model, const Mesh& mesh, const ContactTerms& terms, const SurfaceCover& cover) {
  ContactCertificate certificate{.vertices = {}, .triangles = {}, .surface = cover};
  certificate.vertices.resize(mesh.vertices.size());
  return *ContactChecker(model)(mesh, terms, certificate, by_all_threads()).of_model;
}

/// Until mean and percentiles, or the share within a distance, are about as narrow as this.
SurfaceCover certified(const Model& model, const Mesh& mesh, const std::vector<bool>& counted,
                       const CoverGoal& choose) {
  const std::function<bool()> never = [] { return false; };
  const SeenInterruption interrupted(never);
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  const PatchPlacer placer(model, interrupted);
  return certified_cover({.model = model,
                          .triangles = tree,
                          .placer = placer,
                          .counted = counted,
                          .largest = infinity,
                          .choose = choose,
                          .bytes = 10'000'000,
                          .interrupted = interrupted},
                         octants_of(model, counted));
}

SurfaceCover certified_statistics(const Model& model, const Mesh& mesh, double width) {
  return certified(model, mesh, {}, [width](std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen) {
    verify::choose_for_mean(cells, verify::mean_of(cells), width, chosen);
    const verify::Distribution distribution(cells);
    for (const double percent : percents)
      verify::choose_for_percentile(cells, distribution.percentile(percent), percent / 100.0, 2.0 * width, chosen);
  });
}

SurfaceCover certified_share(const Model& model, const Mesh& mesh, const ContactTerms& terms, double width) {
  return certified(
      model, mesh, terms.counted, [&](std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen) {
        verify::choose_for_share(cells, verify::area_within(cells, terms.distance), terms.distance, width, chosen);
      });
}

struct Case {
  Model model;
  Mesh mesh;
  SurfaceCover cover;   ///< of mean and percentiles
  ContactTerms terms;   ///< of which the last primitive does not count where there are others
  SurfaceCover within;  ///< of what is in contact
  SampledSurface sampled = {};
  SampledSurface sampled_counted = {};
};

Case case_of(const Model& model, const Mesh& mesh, double distance, double width) {
  ContactTerms terms{.distance = distance};
  if (model.primitives.size() > 1) {
    terms.counted.assign(model.primitives.size(), true);
    terms.counted.back() = false;
  }
  constexpr int steps = 32;
  const SampledSurface sampled = sampled_surface(model, mesh, steps);
  return {model,
          mesh,
          certified_statistics(model, mesh, width),
          terms,
          certified_share(model, mesh, terms, width),
          sampled,
          sampled.of(terms.counted)};
}

/// Solids alone, straight, tapered, bent; unions with overlaps, one of them bent; a difference and an intersection.
const std::vector<Case>& cases() {
  const Mesh torus = torus_mesh(3.0, 1.0, 6, 4);
  const SurfaceScene scene;
  const auto& [soap, side, sharp, bent, difference, intersection] = scene;
  static const std::vector<Case> all{case_of({"", {soap}, {}}, torus, 0.7, 0.08),
                                     case_of({"", {sharp}, {}}, torus, 0.7, 0.08),
                                     case_of({"", {bent}, {}}, torus, 0.9, 0.1),
                                     case_of({"", {soap, side, sharp}, {}}, torus, 0.7, 0.2),
                                     case_of({"", {bent, side}, {}}, torus, 0.7, 0.3),
                                     case_of({"", {soap, side}, difference}, torus, 0.7, 0.4),
                                     case_of({"", {soap, side}, intersection}, torus, 1.2, 0.4)};
  return all;
}

/// How far samples may be from the truth: about as much as a row of a grid.
constexpr double of_samples = 0.01;

void expect_near(const Enclosure& proven, double sampled, double scale, const char* what) {
  EXPECT_GE(sampled, proven.lo - of_samples * scale) << what;
  EXPECT_LE(sampled, proven.hi + of_samples * scale) << what;
}

void expect_true_of(const SampledSurface& sampled, const AreaStatistics& proven) {
  expect_near(proven.mean, sampled.mean(), 1.0, "mean");
  for (std::size_t i = 0; i < percents.size(); ++i)
    expect_near(proven.percentiles[i], sampled.percentile(percents[i]), 3.0, "percentile");
}

void expect_true_of(const SampledSurface& sampled, double distance, const AreaWithin& proven) {
  const double area = sampled.area();
  expect_near(proven.area, area, area, "area");
  expect_near(proven.within, sampled.area_within(distance), area, "within");
  expect_near(proven.share, sampled.area_within(distance) / area, 1.0, "share");
}

TEST(SurfaceAreaCertificateTest, HoldsWhatSamplesSay) {
  for (std::size_t i = 0; i < cases().size(); ++i) {
    SCOPED_TRACE(i);
    const Case& of = cases()[i];
    const AreaStatistics statistics = proven_statistics(of.model, of.mesh, of.cover);
    expect_true_of(of.sampled, statistics);
    EXPECT_LE(statistics.mean.width(), 0.41);
    const AreaWithin within = proven_contact(of.model, of.mesh, of.terms, of.within);
    expect_true_of(of.sampled_counted, of.terms.distance, within);
    EXPECT_LE(within.share.width(), 0.41);
    std::cout << of.cover.patches[0].size() << " patches, " << of.cover.on.size() << " on, " << of.cover.off.size()
              << " off: mean [" << statistics.mean.lo << ", " << statistics.mean.hi << "], sampled "
              << of.sampled.mean() << "; share [" << within.share.lo << ", " << within.share.hi << "], sampled "
              << of.sampled_counted.area_within(of.terms.distance) / of.sampled_counted.area() << "\n";
  }
}

/// Of a unit ball from a point at 3: the mean is 3 + 1/9, the distance of a latitude where cos θ = c is √(10 - 6c).
TEST(SurfaceAreaCertificateTest, OfABallAndAPoint) {
  const Model ball{"", {superquadric({1.0, 1.0, 1.0}, {1.0, 1.0}, {})}, {}};
  const Mesh point{.vertices = {{3.0, 0.0, 0.0}}, .triangles = {}};
  const AreaStatistics proven = proven_statistics(ball, point, certified_statistics(ball, point, 1e-3));
  EXPECT_TRUE(proven.mean.contains(3.0 + 1.0 / 9.0));
  EXPECT_LE(proven.mean.width(), 1e-3);
  EXPECT_TRUE(proven.percentiles[0].contains(std::sqrt(10.0)));
  EXPECT_TRUE(proven.percentiles[1].contains(std::sqrt(10.0 + 6.0 * 0.8)));
  const Mesh triangle{.vertices = point.vertices, .triangles = {{0, 0, 0}}};
  const ContactTerms terms{.distance = std::sqrt(10.0)};
  const AreaWithin within = proven_contact(ball, triangle, terms, certified_share(ball, triangle, terms, 1e-3));
  EXPECT_TRUE(within.area.contains(4.0 * std::numbers::pi));
  EXPECT_TRUE(within.within.contains(2.0 * std::numbers::pi));
  EXPECT_TRUE(within.share.contains(0.5));
  EXPECT_LE(within.share.width(), 1e-3);
}

/// All octants halved so often, in turn along and around.
std::vector<PatchProof> evenly_halved(int depth) {
  if (depth == 0) return {PatchProof::near};
  std::vector<PatchProof> patches{depth % 2 == 0 ? PatchProof::halved_along : PatchProof::halved_around};
  const std::vector<PatchProof> half = evenly_halved(depth - 1);
  for (int i = 0; i < 2; ++i) patches.insert(patches.end(), half.begin(), half.end());
  return patches;
}

std::vector<PatchProof> evenly_halved_octants(int depth) {
  std::vector<PatchProof> octants;
  const std::vector<PatchProof> octant = evenly_halved(depth);
  for (int i = 0; i < 8; ++i) octants.insert(octants.end(), octant.begin(), octant.end());
  return octants;
}

/// Large patches bulge, and cover their chords unevenly: what is proven by them is wide, and true. From a point at 3
/// in several directions, of which one is nearest to the middle of a patch, one to a corner.
TEST(SurfaceAreaCertificateTest, LargePatchesHoldTheTruth) {
  const Model ball{"", {superquadric({1.0, 1.0, 1.0}, {1.0, 1.0}, {})}, {}};
  Model upright = ball;
  upright.primitives[0].pose = {};
  for (const Point& direction : {Point{1, 1, 1}, Point{1, 0, 0}, Point{0, 0, 1}, Point{0.3, -0.2, 0.9}}) {
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    const Mesh point{.vertices = {{3 * direction[0] / length, 3 * direction[1] / length, 3 * direction[2] / length}},
                     .triangles = {{0, 0, 0}}};
    for (int depth = 0; depth < 6; ++depth) {
      SCOPED_TRACE(depth);
      const SurfaceCover cover{.patches = {evenly_halved_octants(depth)}, .off = {}, .on = {}};
      const auto statistics = proven_statistics(upright, point, cover);
      EXPECT_TRUE(statistics.mean.contains(3.0 + 1.0 / 9.0));
      for (const double share : {0.01, 0.03, 0.2, 0.5, 0.9, 0.99}) {
        const ContactTerms terms{.distance = std::sqrt(10.0 - 6.0 * (1.0 - 2.0 * share))};
        const AreaWithin within = proven_contact(upright, point, terms, cover);
        EXPECT_TRUE(within.area.contains(4.0 * std::numbers::pi));
        EXPECT_TRUE(within.within.contains(4.0 * std::numbers::pi * share)) << share;
        EXPECT_TRUE(within.share.contains(share)) << share;
      }
    }
  }
}

/// The lens of two unit balls, 1.5 apart, whose caps have the area 2 π · 0.25 each. The other half of the first ball is
/// far from the second, too, and no part of the lens.
TEST(SurfaceAreaCertificateTest, OfSetOperationsThereIsABoundaryInTheBall) {
  Model lens{"", {superquadric({1, 1, 1}, {1, 1}, {}), superquadric({1, 1, 1}, {1, 1}, {1.5, 0, 0})}, {}};
  for (Primitive& primitive : lens.primitives) primitive.pose.quaternion = {1, 0, 0, 0};
  SurfaceCover cover{.patches = {{}, evenly_halved_octants(6)}, .off = {}, .on = {}};
  const std::vector<PatchProof> octant = evenly_halved(6);
  for (unsigned n = 0; n < 8; ++n) {
    std::vector<PatchProof>& patches = cover.patches[0];
    const bool is_left = (n & 1U) != 0;
    for (const PatchProof patch : octant) {
      if (is_left && patch == PatchProof::near) {
        patches.push_back(PatchProof::on);
        cover.on.push_back({{-3, 0, 0}, {{-infinity, infinity}, {{{1, {-1, 0, 0}}}, {}}}});
      }
      patches.push_back(patch);
    }
  }
  const Mesh triangle{.vertices = {{9, 9, 9}}, .triangles = {{0, 0, 0}}};
  const ContactTerms terms{.distance = 30.0, .counted = {true, true}};
  // In the union it is so.
  EXPECT_GE(proven_contact(lens, triangle, terms, cover).area.lo, 1.9 * std::numbers::pi);
  lens.csg = SetExpression{{{.primitive = 0}, {.primitive = 1}}, SetOperation::intersect};
  EXPECT_EQ(proven_contact(lens, triangle, terms, cover).area.lo, 0.0);
}

TEST(SurfaceAreaCertificateTest, OfAProofThatIsCutShortNothingIsProven) {
  const Case& of = cases()[3];
  const auto expect_nothing = [&](const auto& change) {
    SurfaceCover changed = of.within;
    change(changed);
    const AreaWithin within = proven_contact(of.model, of.mesh, of.terms, changed);
    EXPECT_EQ(within.share, (Enclosure{0.0, 1.0}));
    EXPECT_EQ(within.area, (Enclosure{0.0, infinity}));
    EXPECT_EQ(proven_statistics(of.model, of.mesh, changed).mean, (Enclosure{0.0, infinity}));
  };
  expect_nothing([](SurfaceCover& cover) { cover.patches.clear(); });
  expect_nothing([](SurfaceCover& cover) { cover.patches[1].clear(); });
  expect_nothing([](SurfaceCover& cover) { cover.patches[1].pop_back(); });
  expect_nothing([](SurfaceCover& cover) { cover.patches[0].push_back(PatchProof::near); });
  expect_nothing([](SurfaceCover& cover) { cover.off.pop_back(); });
  expect_nothing([](SurfaceCover& cover) { cover.on.pop_back(); });
  ContactTerms others = of.terms;
  others.counted.flip();
  EXPECT_EQ(proven_contact(of.model, of.mesh, others, of.within).area, (Enclosure{0.0, infinity}));
  others.counted.pop_back();
  EXPECT_EQ(proven_contact(of.model, of.mesh, others, of.within).area, (Enclosure{0.0, infinity}));
}

/// Where nobody says where patches lie they may be of the boundary, or not.
TEST(SurfaceAreaCertificateTest, WhatIsNotToldCountsWithAnyShareOfItsArea) {
  const Case& of = cases()[3];
  SurfaceCover untold = of.within;
  for (std::vector<PatchProof>& patches : untold.patches) {
    std::erase(patches, PatchProof::on);
    std::ranges::replace(patches, PatchProof::off, PatchProof::near);
  }
  const AreaWithin within = proven_contact(of.model, of.mesh, of.terms, untold);
  EXPECT_EQ(within.area.lo, 0.0);
  EXPECT_GT(within.area.hi, of.sampled_counted.area());
}

/// The claims are those of the search as far as they are proven, and of the primitives that count alone.
TEST(SurfaceAreaCertificateTest, AFitsContactIsProvenWithItsImplant) {
  const Case& of = cases()[3];
  const ContactAreaOptions options{.distance = of.terms.distance,
                                   .share_width = 0.1,
                                   .of_model = true,
                                   .counted = of.terms.counted,
                                   .device = "host"};
  const ContactAreas found = contact_areas(of.model, of.mesh, options);
  const CertifiedContact certified = certified_contact(of.model, of.mesh, found, options);
  ASSERT_TRUE(certified.claims.of_model.has_value());
  EXPECT_EQ(certified.terms.counted, of.terms.counted);
  EXPECT_TRUE(are_proved(certified.claims, certified.proven));
  expect_true_of(of.sampled_counted, of.terms.distance, *certified.proven.of_model);
  EXPECT_LE(certified.claims.of_model->percent.width(), 20.0);
  ContactClaims past = certified.claims;
  past.of_model->percent.hi = certified.proven.of_model->share.lo * 100.0;
  EXPECT_FALSE(are_proved(past, certified.proven));
}

TEST(SurfaceAreaCertificateTest, ADeviationsMeanIsProvenWithItsLargest) {
  const Case& of = cases()[3];
  DeviationOptions options;
  options.device = "host";
  options.relative_tolerance = 0.2;
  options.statistics_of_surface = false;
  options.statistics_of_model = true;
  options.percentiles = {percents.begin(), percents.end()};
  const Deviation found = deviation(of.model, of.mesh, options);
  const ProvenDeviation proven = certified_deviation(of.model, of.mesh, found, options).proven;
  expect_true_of(of.sampled, *proven.statistics_from_model);
  EXPECT_LE(proven.statistics_from_model->mean.width(), 1.1 * found.from_model->mean->width());
  EXPECT_LE(proven.from_model->width(), 0.25 * proven.from_model->hi);
}

void forge(CertifiedPoint& point, RandomCases& random) {
  const double by = random.log_uniform(1e-12, 1.0) * (random.choice(2) == 0 ? 1.0 : -1.0);
  auto& [distance, certificate] = point.signed_distance;
  switch (random.choice(6)) {
    case 0: point.point[random.choice(3)] += by; break;
    case 1: distance = {distance.lo + by, distance.hi + by}; break;
    case 2: certificate.normals.clear(); break;
    case 3: distance = {0.0, 0.0}; break;
    case 4:
      for (Normal& normal : certificate.normals) normal.primitive = static_cast<std::uint32_t>(random.choice(3));
      break;
    default:
      for (Normal& normal : certificate.normals) {
        double& number = normal.vector[random.choice(3)];
        number = oracle::with_wrong_digit(number, random);
      }
  }
}

std::vector<PatchProof>& any_of(SurfaceCover& cover, RandomCases& random) {
  for (;;) {
    std::vector<PatchProof>& patches = cover.patches[random.choice(cover.patches.size())];
    if (!patches.empty()) return patches;
  }
}

/// Any point of the other proofs, for what is said of more patches than before.
CertifiedPoint any_point(const SurfaceCover& cover, RandomCases& random) {
  const std::vector<CertifiedPoint>& points = random.choice(2) == 0 ? cover.on : cover.off;
  return points.empty() ? CertifiedPoint{{}, {{-infinity, infinity}, {}}} : points[random.choice(points.size())];
}

/// Larger patches, or all from the octants on, are said to lie on the boundary, or off it.
void claim_places(SurfaceCover& cover, RandomCases& random, PatchProof place) {
  const std::size_t one_of = 1 + random.choice(8);
  for (std::vector<PatchProof>& patches : cover.patches) {
    std::vector<PatchProof> told;
    for (const PatchProof patch : patches) {
      const bool is_leaf = patch == PatchProof::near;
      if (place == PatchProof::on && patch != PatchProof::on && random.choice(one_of) == 0) told.push_back(place);
      told.push_back(place == PatchProof::off && is_leaf && random.choice(one_of) == 0 ? place : patch);
    }
    patches = std::move(told);
  }
  for (const PatchProof of : {PatchProof::on, PatchProof::off}) {
    std::size_t expected = 0;
    for (const std::vector<PatchProof>& patches : cover.patches)
      expected += static_cast<std::size_t>(std::ranges::count(patches, of));
    std::vector<CertifiedPoint>& points = of == PatchProof::on ? cover.on : cover.off;
    while (points.size() < expected) points.push_back(any_point(cover, random));
  }
}

/// A split is left out, and what follows of it belongs to other patches.
void leave_out(SurfaceCover& cover, RandomCases& random) {
  std::vector<PatchProof>& patches = any_of(cover, random);
  const auto at = patches.begin() + static_cast<std::ptrdiff_t>(random.choice(patches.size()));
  patches.erase(at, std::min(patches.end(), at + 1 + static_cast<std::ptrdiff_t>(random.choice(8))));
  while (random.choice(3) != 0) patches.push_back(PatchProof::near);
}

constexpr std::size_t kinds = 9;

void forge(SurfaceCover& cover, RandomCases& random, std::size_t kind) {
  switch (kind) {
    case 0:
      for (CertifiedPoint& point : cover.on) forge(point, random);
      break;
    case 1:
      for (CertifiedPoint& point : cover.off) forge(point, random);
      break;
    case 2: {
      std::vector<PatchProof>& patches = any_of(cover, random);
      patches[random.choice(patches.size())] = static_cast<PatchProof>(random.choice(5));
      cover.on.insert(cover.on.begin(), any_point(cover, random));
      cover.off.insert(cover.off.begin(), any_point(cover, random));
      break;
    }
    case 3: leave_out(cover, random); break;
    case 4: {
      std::vector<PatchProof>& patches = any_of(cover, random);
      std::swap(patches[random.choice(patches.size())], patches[random.choice(patches.size())]);
      break;
    }
    case 5: claim_places(cover, random, PatchProof::on); break;
    case 6: claim_places(cover, random, PatchProof::off); break;
    case 7: std::swap(cover.on, cover.off); break;
    default: std::ranges::shuffle(cover.on, std::mt19937_64(random.choice(1000)));
  }
}

/// Claims past what is known of the truth, by what a changed certificate proves.
class SurfaceForger {
 public:
  void try_past(const Enclosure& truth, const Enclosure& proven) {
    for (const Enclosure& past :
         {Enclosure{moved(truth.hi, infinity), infinity}, {-infinity, moved(truth.lo, -infinity)}})
      forgeries_.expect_not_proved(check(past, proven), past, "a claim past the truth");
  }

  /// Where a changed certificate proves no less than the true one, claims past its ends are false for all that is
  /// known.
  void try_past(const AreaStatistics& truth, const AreaStatistics& proven) {
    try_past(truth.mean, proven.mean);
    for (std::size_t i = 0; i < percents.size(); ++i) try_past(truth.percentiles[i], proven.percentiles[i]);
  }
  void try_past(const AreaWithin& truth, const AreaWithin& proven) {
    const ContactClaim known = claim_of(truth);
    const ContactClaim of_proven = claim_of(proven);
    try_past(known.area, of_proven.area);
    try_past(known.within, of_proven.within);
    try_past(known.percent, of_proven.percent);
  }

  [[nodiscard]] std::size_t told() const { return forgeries_.told(); }

 private:
  oracle::Forgeries forgeries_;
};

/// A larger or another model, another mesh: what is proven of these has to hold what samples say of them.
void try_other_subjects(const Case& of, RandomCases& random) {
  Model larger = of.model;
  for (double& axis : larger.primitives[0].superquadric.semi_axes) axis *= random.uniform(0.7, 1.3);
  const SampledSurface of_larger = sampled_surface(larger, of.mesh, 16);
  constexpr double coarser = 3.0;
  const AreaStatistics statistics = proven_statistics(larger, of.mesh, of.cover);
  expect_near(statistics.mean, of_larger.mean(), coarser, "mean of another model");
  Mesh elsewhere = of.mesh;
  for (Point& vertex : elsewhere.vertices) vertex[2] += random.uniform(-0.5, 0.5);
  const SampledSurface from_elsewhere = sampled_surface(of.model, elsewhere, 16).of(of.terms.counted);
  const AreaWithin within = proven_contact(of.model, elsewhere, of.terms, of.within);
  expect_near(within.share, from_elsewhere.area_within(of.terms.distance) / from_elsewhere.area(), 2.0 * coarser,
              "share of another mesh");
}

/// Whatever is left out or changed, what is proven holds what samples say; claims past the ends that the unchanged
/// certificate proves are never proved.
TEST(SurfaceAreaCertificateTest, NeverProvesAForgery) {
  SurfaceForger forger;
  const std::size_t changes = oracle::requested_count("VERISQ_FORGED_SURFACES", 9);
  RandomCases random(11);
  for (std::size_t i = 0; i < cases().size(); ++i) {
    SCOPED_TRACE(i);
    const Case& of = cases()[i];
    const AreaStatistics statistics = proven_statistics(of.model, of.mesh, of.cover);
    const AreaWithin within = proven_contact(of.model, of.mesh, of.terms, of.within);
    forger.try_past(statistics, statistics);
    forger.try_past(within, within);
    for (std::size_t k = 0; k < changes; ++k) {
      SCOPED_TRACE(k % kinds);
      SurfaceCover changed = of.cover;
      forge(changed, random, k % kinds);
      const AreaStatistics of_changed = proven_statistics(of.model, of.mesh, changed);
      expect_true_of(of.sampled, of_changed);
      forger.try_past(statistics, of_changed);
      changed = of.within;
      forge(changed, random, k % kinds);
      const AreaWithin within_changed = proven_contact(of.model, of.mesh, of.terms, changed);
      expect_true_of(of.sampled_counted, of.terms.distance, within_changed);
      forger.try_past(within, within_changed);
    }
    if (!of.model.csg) try_other_subjects(of, random);
  }
  EXPECT_GT(forger.told(), 700U);
}

}  // namespace
}  // namespace verisq::testing
