/// Soundness, the first promise: no enclosure, of the host or of a device, misses the exact signed distance.
///
/// Random solids, poses and points of tests/oracle/random_cases.hpp against MPFR at 200 bits, at tolerance 0 and at
/// 1e-6 of the solid's size. VERISQ_SOUNDNESS_CASES sets the number of cases for the device; the host's own proof,
/// which is slow, takes a tenth. The full run is
///   VERISQ_SOUNDNESS_CASES=1000000 build/release/tests/soundness_test
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/containment.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t points_a_solid = 100;
constexpr std::size_t solids_a_batch = 64;
constexpr std::size_t usual_cases = 20'000;

[[nodiscard]] std::size_t requested_cases() {
  return requested_count("VERISQ_SOUNDNESS_CASES", usual_cases);
}

/// The cases of one solid; the same for an index whatever the number of threads.
struct Group {
  Primitive primitive;
  std::vector<Point> points;
  std::vector<PointFamily> families;

  explicit Group(std::uint64_t index) {
    RandomCases random(index);
    primitive = random.solid();
    for (std::size_t i = 0; i < points_a_solid; ++i) {
      const RandomPoint query = random.point(primitive);
      points.push_back(query.point);
      families.push_back(query.family);
    }
  }

  [[nodiscard]] double size() const {
    return *std::max_element(primitive.superquadric.semi_axes.begin(), primitive.superquadric.semi_axes.end());
  }
  [[nodiscard]] Model model() const { return {"", {primitive}}; }
};

/// What is said about one family of points on one side of the boundary.
struct FamilyTally {
  std::size_t cases = 0;
  std::size_t loose_references = 0;
  std::size_t wide = 0;        ///< at tolerance 1e-6 of the size
  double largest_width = 0.0;  ///< at tolerance 0, in units of PosedSolid::magnitude
};

class Tally {
 public:
  /// `tightest` was asked for with tolerance 0, `tolerant` with `tolerance`.
  void add(const Group& group, std::size_t i, const PosedSolid& solid, const Enclosure& tightest,
           const Enclosure& tolerant, double tolerance) {
    if (hopeless()) return;
    const Point& point = group.points[i];
    const ReferenceDistance reference = solid.signed_distance(point);
    const auto magnitude = solid.magnitude(point).convert_to<double>();
    const std::array evidence{escape(tightest, group.primitive, point, reference),
                              escape(tolerant, group.primitive, point, reference)};
    const std::lock_guard lock(mutex_);
    for (const std::optional<std::string>& line : evidence) {
      if (line) escapes_.push_back(*line);
    }
    const bool outside = reference.lower > 0;
    FamilyTally& family =
        families_[fmt::format("{}, {}", to_string(group.families[i]), outside ? "outside" : "inside")];
    ++family.cases;
    family.loose_references += relative_gap(reference, solid, point) > 1e-30 ? 1 : 0;
    family.wide += verified(tolerant, tolerance) ? 0 : 1;
    family.largest_width = std::max(family.largest_width, tightest.width() / magnitude);
  }

  /// Enough is shown, and every further escape would cost a thorough search.
  [[nodiscard]] bool hopeless() const {
    const std::lock_guard lock(mutex_);
    return escapes_.size() >= most_escapes;
  }

  void print(std::string_view prover) const {
    fmt::print("{:<28}{:>9}{:>18}{:>15}{:>20}\n", prover, "cases", "loose references", "wide at 1e-6",
               "largest width at 0");
    for (const auto& [name, family] : families_) {
      fmt::print("{:<28}{:>9}{:>18}{:>15}{:>20.3g}\n", name, family.cases, family.loose_references, family.wide,
                 family.largest_width);
    }
  }

  /// The escapes in full, and a reference that converged nearly always.
  void expect_sound() const {
    std::size_t cases = 0;
    std::size_t loose = 0;
    for (const auto& [name, family] : families_) {
      cases += family.cases;
      loose += family.loose_references;
    }
    EXPECT_LE(loose, 1 + cases / 10'000) << "the reference itself failed to converge";
    EXPECT_EQ(escapes_.size(), 0U) << "of " << cases << " cases, tested until " << most_escapes << " escaped";
    for (const std::string& line : escapes_) ADD_FAILURE() << line;
  }

 private:
  static constexpr std::size_t most_escapes = 20;

  mutable std::mutex mutex_;
  std::map<std::string, FamilyTally> families_;
  std::vector<std::string> escapes_;
};

/// The enclosures of one group's points at one tolerance.
using Enclosures = std::vector<Enclosure>;

/// `prove(groups, tolerances)` returns an Enclosures for each group.
template <class Prove>
void expect_sound(std::string_view prover, std::size_t cases, const Prove& prove) {
  Tally tally;
  const std::size_t solids = std::max<std::size_t>(1, cases / points_a_solid);
  for (std::size_t first = 0; first < solids && !tally.hopeless(); first += solids_a_batch) {
    std::vector<Group> groups;
    for (std::size_t k = first; k < std::min(solids, first + solids_a_batch); ++k) groups.emplace_back(k);
    std::vector<double> zero(groups.size(), 0.0);
    std::vector<double> usual;
    usual.reserve(groups.size());
    for (const Group& group : groups) usual.push_back(1e-6 * group.size());
    const std::vector<Enclosures> tightest = prove(groups, zero);
    const std::vector<Enclosures> tolerant = prove(groups, usual);
    in_parallel(groups.size(), [&](std::size_t k) {
      const PosedSolid solid(groups[k].primitive.superquadric, groups[k].primitive.pose);
      for (std::size_t i = 0; i < points_a_solid; ++i) {
        tally.add(groups[k], i, solid, tightest[k].at(i), tolerant[k].at(i), usual[k]);
      }
    });
  }
  tally.print(prover);
  tally.expect_sound();
}

TEST(SoundnessTest, HostContainsTheReference) {
  const auto prove = [](std::span<const Group> groups, std::span<const double> tolerances) {
    std::vector<Enclosures> proven(groups.size());
    in_parallel(groups.size(), [&](std::size_t k) {
      const SignedDistance distance(groups[k].model());
      for (const Point& point : groups[k].points) proven[k].push_back(distance(point, tolerances[k]));
    });
    return proven;
  };
  expect_sound("host", requested_cases() / 10, prove);
}

TEST(SoundnessTest, DeviceContainsTheReference) {
  const std::vector<DeviceReport> devices = test_devices();
  if (devices.empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the kernels was NOT tested";
  const auto passed = std::find_if(devices.begin(), devices.end(), [](const DeviceReport& d) { return d.passed; });
  ASSERT_NE(passed, devices.end()) << "no device passed its self-test: " << devices.front().failure;
  std::uint64_t by_device = 0;
  std::uint64_t by_anyone = 0;
  const auto prove = [&](std::span<const Group> groups, std::span<const double> tolerances) {
    std::vector<Enclosures> proven(groups.size());
    for (std::size_t k = 0; k < groups.size(); ++k) {
      MapOptions options{.tolerance = tolerances[k]};
      options.device = std::to_string(passed->index);
      const FinishedMap map = map_in_memory(groups[k].model(), groups[k].points, options);
      for (const MapResult& row : map.rows) proven[k].push_back(row.distance);
      by_device += tolerances[k] > 0 ? map.summary.device_verified : 0;
      by_anyone += tolerances[k] > 0 ? map.summary.points : 0;
    }
    return proven;
  };
  expect_sound(passed->name, requested_cases(), prove);
  fmt::print("at tolerance 1e-6 the device itself verified {} of {}\n", by_device, by_anyone);
  EXPECT_GT(2 * by_device, by_anyone) << "the kernels were hardly tested";
}

}  // namespace
}  // namespace verisq::oracle
