/// Soundness for bent and combined models: no enclosure, of the host or of a device, misses the exact signed distance,
/// and no enclosure of the distance of two such models misses it.
///
/// The random models and points of tests/oracle/random_solids.hpp against proofs by MPFR, sampling and an octree
/// (tests/oracle/solid_reference.hpp), models of spheres against their closed form. VERISQ_SOLID_CASES sets the number
/// of points, without it VERISQ_SOUNDNESS_CASES in proportion, VERISQ_SOLID_PAIRS the number of pairs. The full run is
///   VERISQ_SOLID_CASES=100000 VERISQ_SOLID_PAIRS=600 build/release/tests/soundness_test
///   --gtest_filter='SolidSoundness*'
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_escape.hpp"
#include "tests/oracle/solid_pair_reference.hpp"
#include "tests/oracle/sphere_models.hpp"
#include "tests/oracle/sphere_solid.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t cubes = 3000;
constexpr double relative_tolerance = 1e-6;

// The reference takes so much longer than that of single solids.
constexpr std::size_t share_of_soundness_cases = 50;
constexpr std::size_t usual_cases = 300;

[[nodiscard]] std::size_t requested_points() {
  const std::size_t of_all = requested_count("VERISQ_SOUNDNESS_CASES", usual_cases * share_of_soundness_cases);
  return requested_count("VERISQ_SOLID_CASES", std::max<std::size_t>(1, of_all / share_of_soundness_cases));
}

/// Index of the first model: long runs go on where earlier ones ended.
[[nodiscard]] std::size_t first_model() {
  return requested_count("VERISQ_SOLID_FIRST", 0);
}

/// A model with its queries; the same for an index whatever the number of threads.
struct Group {
  ModelFamily family;
  Model model;
  std::vector<Point> points;
  std::vector<SolidPointFamily> families;

  Group(std::uint64_t index, std::size_t count) : family(model_families[index % model_families.size()]) {
    RandomSolids solids(1000 + index);
    // Intersections may be empty: then there is no distance.
    do {
      model = solids.model(family);
    } while (SolidReference(model).points_of_solid().empty());
    const PlacedModel placed(model);
    for (std::size_t i = 0; i < count; ++i) {
      families.push_back(solid_point_families[i % solid_point_families.size()]);
      points.push_back(solids.point(placed, families.back()));
    }
  }

  [[nodiscard]] double tolerance() const { return relative_tolerance * PlacedModel(model).bounding_ball().radius; }
};

struct FamilyTally {
  std::size_t cases = 0;
  std::size_t wide = 0;          ///< wider than the tolerance
  double largest_width = 0.0;    ///< in units of the size
  std::size_t without_sign = 0;  ///< farther from the boundary than the tolerance, yet the enclosure holds 0
  std::size_t sharp = 0;         ///< an end 1e-5 of the size tighter would have escaped
};

class Tally {
 public:
  void add(std::string_view models, std::string_view points, const Enclosure& enclosure, const SolidFacts& facts,
           double size, const std::optional<std::string>& evidence) {
    const std::lock_guard lock(mutex_);
    if (evidence && evidence_.size() < most_evidence) evidence_.push_back(*evidence);
    escapes_ += evidence ? 1 : 0;
    const auto clear = std::max(facts.lower, Real(-facts.upper)).convert_to<double>();
    const Real slack = facts.side == Membership::inside ? enclosure.hi - facts.lower : facts.upper - enclosure.lo;
    for (const std::string_view name : {models, points}) {
      FamilyTally& family = families_[std::string(name)];
      ++family.cases;
      family.wide += verified(enclosure, relative_tolerance * size) ? 0 : 1;
      family.largest_width = std::max(family.largest_width, enclosure.width() / size);
      family.without_sign += clear > relative_tolerance * size && enclosure.lo < 0 && enclosure.hi > 0 ? 1 : 0;
      family.sharp += slack < 1e-5 * size ? 1 : 0;
    }
  }

  void print(std::string_view prover) const {
    fmt::print("{:<24}{:>8}{:>14}{:>18}{:>15}{:>15}\n", prover, "cases", "wide at 1e-6", "largest width",
               "without sign", "sharp");
    for (const auto& [name, family] : families_) {
      fmt::print("{:<24}{:>8}{:>14}{:>18.3g}{:>15}{:>15}\n", name, family.cases, family.wide, family.largest_width,
                 family.without_sign, family.sharp);
    }
  }

  void expect_sound() const {
    EXPECT_EQ(escapes_, 0U);
    for (const std::string& line : evidence_) ADD_FAILURE() << line;
    for (const auto& [name, family] : families_) {
      EXPECT_EQ(family.without_sign, 0U) << name;
      EXPECT_GT(2 * family.sharp, family.cases) << name << ": the reference would hardly notice an escape";
    }
  }

 private:
  static constexpr std::size_t most_evidence = 20;

  std::mutex mutex_;
  std::map<std::string, FamilyTally> families_;
  std::size_t escapes_ = 0;
  std::vector<std::string> evidence_;
};

/// `prove(group)` returns an enclosure for each point.
template <class Prove>
void expect_sound(std::string_view prover, std::size_t points, std::size_t points_a_model, const Prove& prove) {
  Tally tally;
  const std::size_t models = std::max(model_families.size(), points / points_a_model);
  const std::size_t count = std::max<std::size_t>(1, points / models);
  in_parallel(models, [&](std::size_t index) {
    const Group group(first_model() + index, count);
    const SolidReference reference(group.model);
    const std::vector<Enclosure> proven = prove(group);
    for (std::size_t i = 0; i < count; ++i) {
      const SolidFacts facts = reference.facts(group.points[i], cubes);
      tally.add(to_string(group.family), to_string(group.families[i]), proven.at(i), facts, reference.size(),
                escape(proven[i], group.model, group.points[i], facts.lower, facts.upper));
    }
  });
  tally.print(prover);
  tally.expect_sound();
}

[[nodiscard]] std::vector<Enclosure> host_enclosures(const Group& group) {
  const SignedDistance distance(group.model);
  std::vector<Enclosure> proven;
  for (const Point& point : group.points) proven.push_back(distance(point, group.tolerance()));
  return proven;
}

TEST(SolidSoundnessTest, HostContainsTheReference) {
  expect_sound("host", requested_points(), 35, host_enclosures);
}

TEST(SolidSoundnessTest, DeviceContainsTheReferenceAndMeetsTheHost) {
  const std::vector<DeviceReport> devices = test_devices();
  if (devices.empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the kernels was NOT tested";
  const auto passed = std::find_if(devices.begin(), devices.end(), [](const DeviceReport& d) { return d.passed; });
  ASSERT_NE(passed, devices.end()) << "no device passed its self-test: " << devices.front().failure;
  std::mutex one_at_a_time;
  std::size_t by_device = 0;
  const auto prove = [&](const Group& group) {
    const std::lock_guard lock(one_at_a_time);
    MapOptions options{.tolerance = group.tolerance()};
    options.device = std::to_string(passed->index);
    const FinishedMap map = map_in_memory(group.model, group.points, options);
    by_device += map.summary.device_verified;
    const SignedDistance host(group.model);
    std::vector<Enclosure> proven;
    for (std::size_t i = 0; i < map.rows.size(); ++i) {
      proven.push_back(map.rows[i].distance);
      // The host has had its say about the others, at length.
      if (i % 5 != 0 || map.rows[i].status != Status::device_verified) continue;
      const Enclosure again = host(group.points[i], group.tolerance());
      // Both are proven: they have a common number.
      EXPECT_LE(proven[i].lo, again.hi) << model_json(group.model)
                                        << fmt::format(" {:.17g}", fmt::join(group.points[i], ","));
      EXPECT_LE(again.lo, proven[i].hi) << model_json(group.model)
                                        << fmt::format(" {:.17g}", fmt::join(group.points[i], ","));
    }
    return proven;
  };
  // Compiling a model takes as long as some thousand points.
  expect_sound(passed->name, requested_points(), std::max<std::size_t>(100, requested_points() / 25), prove);
  fmt::print("the device itself verified {}\n", by_device);
}

TEST(SolidSoundnessTest, ContainsTheClosedFormOfSpheres) {
  const std::size_t models = std::max<std::size_t>(6, requested_points() / 100);
  constexpr std::size_t points_a_model = 50;
  std::mutex mutex;
  std::size_t compared = 0;
  std::size_t wide = 0;
  in_parallel(models, [&](std::size_t index) {
    RandomCases random(index);
    RandomSolids solids(index);
    const Model model = random_spheres(random);
    const SphereSolid spheres(model);
    const PlacedModel placed(model);
    const SignedDistance distance(model);
    const double tolerance = relative_tolerance * placed.bounding_ball().radius;
    for (std::size_t i = 0; i < points_a_model; ++i) {
      const Point q = solids.point(placed, solid_point_families[i % solid_point_families.size()]);
      const std::optional<ReferenceDistance> exact = spheres.signed_distance(q);
      if (!exact || !isfinite(exact->upper)) continue;
      const Enclosure proven = distance(q, tolerance);
      const auto evidence = escape(proven, model, q, exact->lower, exact->upper);
      const std::lock_guard lock(mutex);
      ++compared;
      wide += verified(proven, tolerance) ? 0 : 1;
      if (evidence) ADD_FAILURE() << *evidence;
    }
  });
  fmt::print("{} points against the closed form of spheres, {} wide at 1e-6\n", compared, wide);
  EXPECT_GT(compared, models * points_a_model / 2);
}

/// |d_k - d_0| is at most the largest displacement: to first order k (z^2/2 + |r z|), and the rest is smaller.
TEST(SolidSoundnessTest, VanishingCurvatureConvergesToTheUnbentAnswer) {
  const Superquadric stem{{0.6, 0.9, 3.0}, {0.4, 0.9}};
  const Pose pose{{0.1, -0.2, 0.3}, {0.9, 0.1, -0.2, 0.3}};
  const Model straight{"", {{"stem", stem, pose, {}}}, {}};
  const SignedDistance unbent(straight);
  const PlacedModel placed(straight);
  constexpr double tolerance = 1e-9;
  for (const double curvature : {1e-5, 1e-9, 1e-300, -1e-300}) {
    const SignedDistance bent(Model{"", {{"stem", stem, pose, Bend{curvature, 70.0}}}, {}});
    const double displacement = std::abs(curvature) * (3.0 * 3.0 + 3.0 * 0.9);
    RandomSolids solids(9);
    for (int i = 0; i < 12; ++i) {
      const Point q = solids.point(placed, solid_point_families[static_cast<std::size_t>(i) % 4]);
      const Enclosure a = unbent(q, tolerance);
      const Enclosure b = bent(q, tolerance);
      EXPECT_LE(b.lo, a.hi + displacement) << curvature << ' ' << i;
      EXPECT_GE(b.hi, a.lo - displacement) << curvature << ' ' << i;
      // Wider only where the search ran out of cubes; far queries have wide cubes to go through.
      EXPECT_LE(b.width(), 1e-4) << curvature << ' ' << i;
    }
  }
}

TEST(SolidSoundnessTest, PairsContainTheReference) {
  const std::size_t pairs = requested_count("VERISQ_SOLID_PAIRS", 24);
  std::mutex mutex;
  std::map<Proximity, std::size_t> found;
  std::size_t wide = 0;
  in_parallel(pairs, [&](std::size_t index) {
    RandomSolids solids(5000 + index);
    const auto [a, b] = solids.pair();
    const SolidPairFacts facts = pair_facts(a, b, 20 * cubes);
    const double size = std::max(PlacedModel(a).bounding_ball().radius, PlacedModel(b).bounding_ball().radius);
    const ModelSearch search(a, b);
    const auto start = std::chrono::steady_clock::now();
    SearchOptions options{1e-2 * size};
    options.interrupted = [&] { return std::chrono::steady_clock::now() - start > std::chrono::seconds(2); };
    const SearchedDistance searched = search(Pose{}, options);
    const auto evidence = escape(searched.distance, a, {}, facts.lower, facts.upper);
    const std::lock_guard lock(mutex);
    ++found[searched.proximity];
    wide += verified(searched.distance, options.tolerance) ? 0 : 1;
    if (evidence) ADD_FAILURE() << *evidence << "; against " << model_json(b);
    const bool meet = facts.upper == 0;
    if (meet && searched.proximity == Proximity::separated) ADD_FAILURE() << "overlap called separated, " << index;
    if (facts.lower > 0 && searched.proximity == Proximity::overlapping)
      ADD_FAILURE() << "gap called overlap, " << index;
  });
  fmt::print("pairs: {} separated, {} overlapping, {} undecided; {} wide at 1e-2\n", found[Proximity::separated],
             found[Proximity::overlapping], found[Proximity::undecided], wide);
}

}  // namespace
}  // namespace verisq::oracle
