/// Soundness for triangles: no enclosure, of the host or of a device, misses the exact distance.
///
/// The random triangles of tests/oracle/random_triangles.hpp around the solids of the paper's Table 5 and around random
/// solids, in random poses, against MPFR at 200 bits. VERISQ_TRIANGLE_CASES sets the number of cases an object for the
/// device; the host's own proof takes a tenth of them. The full run is
///   VERISQ_TRIANGLE_CASES=100000 build/release/tests/soundness_test --gtest_filter='*TriangleSoundness*'
/// which takes hours, because most families are hard for the reference; VERISQ_TRIANGLE_FAMILY=anywhere limits it to
/// triangles with random corners (20 minutes on two cores).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/containment.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/published_solids.hpp"
#include "tests/oracle/random_triangles.hpp"
#include "tests/oracle/triangle_reference.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t triangles_a_pose = 100;
constexpr std::size_t usual_cases = 1'000;

[[nodiscard]] std::size_t requested_cases() {
  return requested_count("VERISQ_TRIANGLE_CASES", usual_cases);
}

/// The next triangle of the family that VERISQ_TRIANGLE_FAMILY names; of any family where it is not set.
[[nodiscard]] RandomTriangle requested_triangle(RandomCases& random, const Primitive& solid) {
  const char* family = std::getenv("VERISQ_TRIANGLE_FAMILY");
  RandomTriangle query = random_triangle(random, solid);
  while (family != nullptr && to_string(query.family) != family) query = random_triangle(random, solid);
  return query;
}

/// The triangles around one posed solid; the same for an index whatever the number of threads.
struct Group {
  Primitive primitive;
  std::vector<Triangle> triangles;
  std::vector<TriangleFamily> families;
  std::vector<TriangleReference> references;  ///< empty until `refer`

  /// Without a superquadric, a random one.
  Group(std::uint64_t index, const std::optional<Superquadric>& superquadric) {
    RandomCases random(index);
    primitive = random.solid(superquadric);
    for (std::size_t i = 0; i < triangles_a_pose; ++i) {
      const RandomTriangle query = requested_triangle(random, primitive);
      triangles.push_back(query.triangle);
      families.push_back(query.family);
    }
  }

  void refer() {
    const PosedSolid solid(primitive.superquadric, primitive.pose);
    for (const Triangle& triangle : triangles) references.push_back(reference_distance(solid, triangle));
  }

  [[nodiscard]] double size() const {
    return *std::max_element(primitive.superquadric.semi_axes.begin(), primitive.superquadric.semi_axes.end());
  }
  [[nodiscard]] Model model() const { return {"", {primitive}}; }
};

/// What is said about one family of triangles, or all; widths in units of the largest semi-axis.
struct FamilyTally {
  std::size_t cases = 0;
  std::size_t escapes = 0;
  std::size_t zero = 0;  ///< proven to meet the solid
  std::size_t loose_references = 0;
  std::size_t tight = 0;  ///< width at most 1e-12
  double worst_width = 0.0;

  void add(const Enclosure& enclosure, const TriangleReference& reference, double size, bool escaped) {
    ++cases;
    escapes += escaped ? 1 : 0;
    zero += enclosure.hi == 0 ? 1 : 0;
    loose_references += reference.upper - reference.lower > 1e-20 * size ? 1 : 0;
    tight += enclosure.width() <= 1e-12 * size ? 1 : 0;
    worst_width = std::max(worst_width, enclosure.width() / size);
  }

  void print(std::string_view name) const {
    fmt::print("{:<32}{:>8}{:>9}{:>8}{:>12.3f} %{:>14.3g}\n", name, cases, escapes, zero,
               100.0 * static_cast<double>(tight) / static_cast<double>(std::max<std::size_t>(1, cases)), worst_width);
  }
};

class Tally {
 public:
  void add(const Group& group, std::size_t i, const Enclosure& enclosure) {
    const TriangleReference& reference = group.references[i];
    const std::optional<std::string> line = escape(enclosure, group.primitive, group.triangles[i], reference);
    if (line && evidence_.size() < most_evidence) evidence_.push_back(*line);
    all_.add(enclosure, reference, group.size(), line.has_value());
    families_[to_string(group.families[i])].add(enclosure, reference, group.size(), line.has_value());
  }

  void print(std::string_view prover, std::string_view object) const {
    fmt::print("{:<32}{:>8}{:>9}{:>8}{:>14}{:>14}\n", fmt::format("{}, {}", object, prover), "cases", "escapes", "zero",
               "<= 1e-12 size", "worst width");
    for (const auto& [name, family] : families_) family.print(fmt::format("  {}", name));
    all_.print("  all");
  }

  void expect_sound() const {
    EXPECT_GT(all_.cases, 0U);
    EXPECT_LE(all_.loose_references, 1 + all_.cases / 10'000) << "the reference itself failed to converge";
    EXPECT_EQ(all_.escapes, 0U) << "of " << all_.cases << " cases";
    for (const std::string& line : evidence_) ADD_FAILURE() << line;
  }

 private:
  static constexpr std::size_t most_evidence = 20;

  std::map<std::string_view, FamilyTally> families_;
  FamilyTally all_;
  std::vector<std::string> evidence_;
};

[[nodiscard]] std::vector<Enclosure> host_enclosures(const Group& group) {
  const TriangleDistance distance(group.model());
  std::vector<Enclosure> enclosures;
  for (const Triangle& triangle : group.triangles) enclosures.push_back(distance(triangle));
  return enclosures;
}

/// The enclosures of a map at tolerance 0, and how many the device itself verified at 1e-6 sizes.
struct MappedTriangles {
  std::vector<Enclosure> enclosures;
  MapSummary summary;
};

[[nodiscard]] MappedTriangles mapped(const Group& group, const std::string& device, double tolerance) {
  MapOptions options{.tolerance = tolerance};
  options.device = device;
  TriangleMapper mapper(group.model(), options);
  MappedTriangles result;
  std::size_t delivered = 0;
  const Source<Triangle> source = [&](std::span<Triangle> chunk) {
    const std::size_t count = std::min(chunk.size(), group.triangles.size() - delivered);
    std::copy_n(group.triangles.begin() + static_cast<std::ptrdiff_t>(delivered), count, chunk.begin());
    delivered += count;
    return count;
  };
  const Sink<Triangle> sink = [&](std::span<const Triangle>, std::span<const MapResult> rows,
                                  std::span<const Certificate>) {
    for (const MapResult& row : rows) result.enclosures.push_back(row.distance);
  };
  result.summary = mapper.map(source, sink);
  return result;
}

/// One object in many poses, or random solids.
struct Object {
  std::string_view name;
  std::optional<Superquadric> superquadric;
};

class TriangleSoundnessTest : public testing::TestWithParam<Object> {};

TEST_P(TriangleSoundnessTest, HostAndDeviceContainTheReference) {
  constexpr std::size_t poses_a_batch = 64;
  const std::vector<DeviceReport> devices = test_devices();
  const auto passed = std::find_if(devices.begin(), devices.end(), [](const DeviceReport& d) { return d.passed; });
  const bool with_device = passed != devices.end();
  ASSERT_TRUE(with_device || devices.empty()) << "no device passed its self-test: " << devices.front().failure;

  Tally host;
  Tally device;
  std::uint64_t by_device = 0;
  const std::size_t poses = std::max<std::size_t>(1, requested_cases() / triangles_a_pose);
  for (std::size_t first = 0; first < poses; first += poses_a_batch) {
    std::vector<Group> groups;
    for (std::size_t k = first; k < std::min(poses, first + poses_a_batch); ++k) {
      groups.emplace_back(k, GetParam().superquadric);
    }
    std::vector<std::vector<Enclosure>> on_host(groups.size());
    in_parallel(groups.size(), [&](std::size_t k) {
      groups[k].refer();
      if ((first + k) % 10 == 0) on_host[k] = host_enclosures(groups[k]);
    });
    for (std::size_t k = 0; k < groups.size(); ++k) {
      for (std::size_t i = 0; i < on_host[k].size(); ++i) host.add(groups[k], i, on_host[k][i]);
      if (!with_device) continue;
      const std::string index = std::to_string(passed->index);
      const MappedTriangles tightest = mapped(groups[k], index, 0.0);
      const MappedTriangles tolerant = mapped(groups[k], index, 1e-6 * groups[k].size());
      by_device += tolerant.summary.device_verified;
      ASSERT_EQ(tightest.enclosures.size(), triangles_a_pose);
      ASSERT_EQ(tolerant.enclosures.size(), triangles_a_pose);
      for (std::size_t i = 0; i < triangles_a_pose; ++i) {
        device.add(groups[k], i, tightest.enclosures[i]);
        const auto line =
            escape(tolerant.enclosures[i], groups[k].primitive, groups[k].triangles[i], groups[k].references[i]);
        EXPECT_FALSE(line.has_value()) << *line;
      }
    }
  }
  host.print("host", GetParam().name);
  host.expect_sound();
  if (!with_device) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the triangle kernel was NOT tested";
  device.print(passed->name, GetParam().name);
  fmt::print("at tolerance 1e-6 the device itself verified {} of {}\n", by_device, poses * triangles_a_pose);
  device.expect_sound();
  EXPECT_GT(2 * by_device, poses * triangles_a_pose) << "the kernel was hardly tested";
}

[[nodiscard]] std::vector<Object> objects() {
  std::vector<Object> result;
  result.reserve(published_solids.size() + 1);
  for (const PublishedSolid& solid : published_solids) result.push_back({solid.name, solid.superquadric});
  result.push_back({"random", std::nullopt});
  return result;
}

INSTANTIATE_TEST_SUITE_P(Objects, TriangleSoundnessTest, testing::ValuesIn(objects()),
                         [](const auto& object) { return std::string(object.param.name); });

}  // namespace
}  // namespace verisq::oracle
