/// Soundness of tapered solids: no enclosure, of the host or of a device, misses the signed distance.
///
/// Random solids with ratios of the ends up to 19 and queries of known distance (tests/oracle/tapered_contact.hpp), at
/// tolerance 0 and at 1e-6 of the solid's size. The full run is
///   VERISQ_SOUNDNESS_CASES=1000000 build/release/tests/tapered_soundness_test
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <random>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/tapered_contact.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t points_a_solid = 200;
constexpr std::size_t usual_cases = 4'000;

struct Case {
  Primitive primitive;
  std::vector<KnownContact> contacts;

  [[nodiscard]] Model model() const { return {"", {primitive}}; }
  [[nodiscard]] double size() const { return std::ranges::max(primitive.superquadric.semi_axes); }
  [[nodiscard]] double radius() const { return bounding_radius(model()); }
  [[nodiscard]] std::vector<Point> points() const {
    std::vector<Point> result;
    for (const KnownContact& contact : contacts) result.push_back(contact.query);
    return result;
  }
};

Case random_case(std::uint64_t index) {
  std::mt19937_64 random(index);
  Case result{random_tapered(random, 19.0), {}};
  const TaperedSolid solid(result.primitive);
  const double size = result.size();
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < points_a_solid; ++i) {
    const Triple<double> direction{normal(random), normal(random), normal(random)};
    const double apart = size * std::exp(std::uniform_real_distribution(std::log(1e-6), std::log(10.0))(random));
    if (i % 8 == 5) {  // on the surface, but for rounding
      result.contacts.push_back(solid.contact(direction, 0.0));
      continue;
    }
    result.contacts.push_back(solid.contact(direction, i % 4 == 3 ? -std::min(apart, 0.01 * size) : apart));
  }
  return result;
}

std::string described(const Case& tested, const KnownContact& contact, const Enclosure& found) {
  const auto& [axes, exponents, taper] = tested.primitive.superquadric;
  return fmt::format("[{:.17g}, {:.17g}] for [{}, {}]: axes {} {} {}, exponents {} {}, taper {}, at {} {} {}", found.lo,
                     found.hi, text(contact.lower), text(contact.upper), axes[0], axes[1], axes[2], exponents[0],
                     exponents[1], taper, contact.query[0], contact.query[1], contact.query[2]);
}

class Tally {
 public:
  void add(const Case& tested, const KnownContact& contact, const Enclosure& found, double tolerance) {
    const bool escapes = !(Real(found.lo) <= contact.upper && Real(found.hi) >= contact.lower);
    const bool outside = contact.lower > 0;
    double magnitude = tested.radius();  // of what rounding errors are in proportion to
    for (const double x : contact.query) magnitude = std::max(magnitude, std::fabs(x));
    const std::lock_guard lock(mutex_);
    ++cases_;
    if (escapes) {
      ++escapes_;
      ADD_FAILURE() << described(tested, contact, found);
    }
    if (outside && tolerance == 0.0 && found.width() / magnitude > largest_width_) {
      largest_width_ = found.width() / magnitude;
      widest_ = described(tested, contact, found);
    }
    if (tolerance > 0.0 && found.width() > tolerance) ++wide_;
  }

  void print(const std::string& prover, std::uint64_t by_device) const {
    fmt::print(
        "{}: {} cases, {} escapes, {} wide at 1e-6 of the size, {} by the device; largest width outside at 0: {:.3g}: "
        "{}\n",
        prover, cases_, escapes_, wide_, by_device, largest_width_, widest_);
  }

  [[nodiscard]] bool hopeless() const { return escapes_ > 10; }
  [[nodiscard]] double largest_width() const { return largest_width_; }
  [[nodiscard]] std::size_t wide() const { return wide_; }

 private:
  std::mutex mutex_;
  std::size_t cases_ = 0;
  std::size_t escapes_ = 0;
  std::size_t wide_ = 0;
  double largest_width_ = 0.0;
  std::string widest_;  // its case
};

std::size_t solids(std::size_t share) {
  return std::max<std::size_t>(1, requested_count("VERISQ_SOUNDNESS_CASES", usual_cases) / share / points_a_solid);
}

TEST(TaperedSoundnessTest, HostContainsTheKnownDistance) {
  Tally tally;
  in_parallel(solids(2), [&](std::size_t k) {
    if (tally.hopeless()) return;
    const Case tested = random_case(k);
    const SignedDistance distance(tested.model());
    for (const KnownContact& contact : tested.contacts) {
      for (const double tolerance : {0.0, 1e-6 * tested.size()})
        tally.add(tested, contact, distance(contact.query, tolerance), tolerance);
    }
  });
  tally.print("host", 0);
  EXPECT_EQ(tally.wide(), 0U);
  EXPECT_LE(tally.largest_width(), 2e-14);
}

TEST(TaperedSoundnessTest, DeviceContainsTheKnownDistance) {
  if (test_devices().empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the kernels was NOT tested";
  Tally tally;
  std::uint64_t by_device = 0;
  for (std::size_t k = 0; k < solids(1) && !tally.hopeless(); ++k) {
    const Case tested = random_case(k);
    for (const double tolerance : {0.0, 1e-6 * tested.size()}) {
      const FinishedMap map = map_in_memory(tested.model(), tested.points(), {.tolerance = tolerance});
      by_device += map.summary.device_verified;
      for (std::size_t i = 0; i < tested.contacts.size(); ++i)
        tally.add(tested, tested.contacts[i], map.rows.at(i).distance, tolerance);
    }
  }
  tally.print("device", by_device);
  EXPECT_LE(tally.largest_width(), 2e-14);
}

}  // namespace
}  // namespace verisq::oracle
