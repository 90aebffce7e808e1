/// What runs remember of devices: programs, which no damage keeps from being compiled again, and outcomes of the
/// self-tests, of the arithmetic, which hold for one binary alone, and of each program's kernels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verisq/device.hpp"
#include "verisq/error.hpp"
#include "verisq/map.hpp"
#include "verisq/octree.hpp"

namespace verisq::device {
namespace {

using ::testing::StartsWith;

/// A cache of its own, empty for each test. PoCL keeps the one that it would have without: it looks for it once, and
/// compiling everything again would take minutes.
class DeviceCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const home = std::getenv("HOME");
    const char* const caches = std::getenv("XDG_CACHE_HOME");
    if (caches != nullptr || home != nullptr) {
      const std::string folder = caches != nullptr ? caches : std::string(home) + "/.cache";
      setenv("POCL_CACHE_DIR", (folder + "/pocl/kcache").c_str(), 0);
    }
    setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
    std::filesystem::remove_all(folder_ / "verisq");
    std::vector<cl::Platform> platforms;
    try {
      cl::Platform::get(&platforms);
      platforms.at(0).getDevices(CL_DEVICE_TYPE_ALL, &devices_);
    } catch (const cl::Error&) {
      GTEST_SKIP() << "no OpenCL device";
    }
  }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  [[nodiscard]] const cl::Device& device() const { return devices_.at(0); }

  [[nodiscard]] std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "verisq")) all.push_back(entry.path());
    return all;
  }

  /// The keys of all files: what follows the first line, which says how long they are.
  [[nodiscard]] std::vector<std::string> keys(std::string_view beginning) const {
    std::vector<std::string> found;
    for (const std::filesystem::path& path : files()) {
      std::ifstream file(path, std::ios::binary);
      std::string words;
      std::string length;
      file >> words >> words >> words >> length;
      std::getline(file, words);
      std::string key(std::stoul(length), '\0');
      file.read(key.data(), static_cast<std::streamsize>(key.size()));
      if (key.starts_with(beginning)) found.push_back(key);
    }
    return found;
  }

  [[nodiscard]] std::string the_key(std::string_view beginning) const {
    const auto found = keys(beginning);
    EXPECT_EQ(found.size(), 1U) << beginning;
    return found.at(0);
  }

  inline static const testing::TemporaryFolder folder_;
  std::vector<cl::Device> devices_;
};

constexpr std::string_view doubling = R"(
kernel void twice(global double* x) { x[get_global_id(0)] *= 2.0; }
)";

class ProgramCacheTest : public DeviceCacheTest {
 protected:
  /// Loads the program and runs it.
  void expect_doubles() const {
    const cl::Context context(device());
    cl::Kernel kernel(load_program(context, device(), 1, doubling).program, "twice");
    const cl::CommandQueue queue(context, device());
    double number = 21.0;
    const cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof number, &number);
    kernel.setArg(0, buffer);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof number, &number);
    EXPECT_EQ(number, 42.0);
  }

  [[nodiscard]] std::string bytes() const {
    std::ifstream file(files().at(0), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void overwrite(std::string_view bytes) const { std::ofstream(files().at(0), std::ios::binary) << bytes; }
};

/// PoCL 3.1 aborts the process on a truncated binary.
TEST_F(ProgramCacheTest, CompilesAgainWhatIsTruncated) {
  expect_doubles();
  const std::string whole = bytes();
  for (const double share : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99}) {
    overwrite(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    expect_doubles();
    EXPECT_EQ(keys("program").size(), 1U) << share;
  }
}

TEST_F(ProgramCacheTest, CompilesAgainWhereBitsAreFlipped) {
  expect_doubles();
  const std::string whole = bytes();
  for (std::size_t i = 1; i < 8; ++i) {
    std::string damaged = whole;
    damaged[i * whole.size() / 8] = static_cast<char>(~damaged[i * whole.size() / 8]);
    overwrite(damaged);
    expect_doubles();
    EXPECT_NE(bytes(), damaged) << i;
  }
}

/// Intact, but nothing that this driver would take.
TEST_F(ProgramCacheTest, CompilesAgainWhatTheDriverRejects) {
  expect_doubles();
  const std::string key = the_key("program");
  for (const std::string_view rejected : {"", "not a program"}) {
    store_in_cache(key, rejected);
    expect_doubles();
    EXPECT_NE(cached(key), rejected);
  }
}

class SelfTestCacheTest : public DeviceCacheTest {
 protected:
  [[nodiscard]] static DeviceReport report() { return test_devices().at(0); }
};

TEST_F(SelfTestCacheTest, BelievesOnlyWhatIsSaidInSoManyWords) {
  ASSERT_TRUE(report().passed);
  const std::string key = the_key("self-test");
  EXPECT_EQ(cached(key), "passed");
  for (const std::string_view unclear : {"", "pass", "passed?", "failed"}) {
    store_in_cache(key, unclear);
    EXPECT_TRUE(report().passed) << unclear;
    EXPECT_EQ(cached(key), "passed") << "tested again: " << unclear;
  }
  store_in_cache(key, "failed: add_down of something");
  EXPECT_FALSE(report().passed) << "remembered";
  EXPECT_EQ(report().failure, "add_down of something");
}

/// Another binary under the key of the right sources: of kernels that do not round.
TEST_F(SelfTestCacheTest, TestsEveryBinaryOnItsOwn) {
  ASSERT_TRUE(report().passed);
  std::string sources = device::self_test_sources();
  const std::string_view step = "return c - fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA));";
  ASSERT_NE(sources.find(step), std::string::npos);
  sources.replace(sources.find(step), step.size(), "return c;");
  const std::string key = the_key("program");
  const auto broken = load_program(cl::Context(device()), device(), report().vector_width, sources);
  ASSERT_FALSE(broken.binary.empty());
  store_in_cache(key, broken.binary);
  const DeviceReport found = report();
  EXPECT_FALSE(found.passed);
  EXPECT_THAT(found.failure, StartsWith("add_down"));
  EXPECT_EQ(keys("self-test").size(), 2U);
}

/// Kernels are tried on samples program by program, when they are made ready, and each program once.
class SampledKernelsTest : public DeviceCacheTest {
 protected:
  static Primitive solid(double x) { return {"", {{1.0, 0.8, 0.6}, {0.5, 1.0}}, {{x, 0.0, 0.0}}, {}}; }

  static Model one() { return {"", {solid(0.0)}, {}}; }
  static Model two() { return {"", {solid(0.0), solid(0.9)}, {}}; }
  static Model bent() {
    Model model = one();
    model.primitives[0].bend = Bend{0.3, 20.0};
    return model;
  }

  static MapOptions options(std::string device = "auto") {
    MapOptions options{1e-6};
    options.device = std::move(device);
    return options;
  }

  /// Maps points outside, and on request one inside as well.
  static MapSummary map(const Model& model, bool inside, const std::string& device = "auto") {
    std::vector<Point> points{{3.0, 0.0, 0.0}, {0.0, 2.0, 1.0}};
    if (inside) points.push_back({0.1, 0.05, 0.0});
    std::vector<MapResult> rows(points.size());
    return PointMapper(model, options(device)).map(points, rows);
  }

  static constexpr std::string_view outcomes = "sampled kernels";

  /// As if the kernels of all programs so far had failed.
  void fail_all() const {
    for (const std::string& key : keys(outcomes)) store_in_cache(key, "failed: sample 3 gave [1, 2]");
  }

  [[nodiscard]] std::string refused() const { return "refused " + device().getInfo<CL_DEVICE_NAME>() + ": "; }
};

TEST_F(SampledKernelsTest, TrueKernelsPassAndEachProgramIsTriedOnce) {
  EXPECT_NE(map(one(), false).device, "host");
  ASSERT_EQ(keys(outcomes).size(), 1U) << "points inside were not met";
  EXPECT_EQ(cached(keys(outcomes).front()), "passed");
  EXPECT_NE(map(one(), true).device, "host");
  EXPECT_EQ(keys(outcomes).size(), 2U);
  EXPECT_NE(map(two(), true).device, "host");
  EXPECT_EQ(keys(outcomes).size(), 2U) << "the same program of points";
  EXPECT_NE(map(bent(), true).device, "host");
  EXPECT_EQ(keys(outcomes).size(), 3U);
  for (const std::string& key : keys(outcomes)) EXPECT_EQ(cached(key), "passed") << key.substr(0, 200);
}

TEST_F(SampledKernelsTest, QueriesOfAllKindsAreTried) {
  Model tapered = one();
  tapered.primitives[0].superquadric.taper = 2.0;
  EXPECT_NE(map(tapered, true).device, "host");
  const Source<Triangle> no_triangles = [](std::span<Triangle>) { return std::size_t{0}; };
  EXPECT_NE(TriangleMapper(one(), options()).map(no_triangles, {}).device, "host");
  const Source<Pose> no_poses = [](std::span<Pose>) { return std::size_t{0}; };
  EXPECT_NE(PoseMapper(one(), two(), options()).map(no_poses, {}).device, "host");
  OctreeOptions octree;
  octree.depth = 2;
  EXPECT_NE(OctreeBuilder(bent(), octree).build().device, "host");
  EXPECT_EQ(keys(outcomes).size(), 6U) << "tapered: at once, in steps of both kinds; triangles; pairs; octree";
  for (const std::string& key : keys(outcomes)) EXPECT_EQ(cached(key), "passed") << key.substr(0, 200);
}

TEST_F(SampledKernelsTest, WhatFailsIsRefusedWhereItIsNamedAndPassedOverWhereNot) {
  static_cast<void>(map(one(), true));
  static_cast<void>(map(bent(), true));
  OctreeOptions octree;
  octree.depth = 2;
  static_cast<void>(OctreeBuilder(bent(), octree).build());
  fail_all();
  for (const Model& model : {one(), two(), bent()}) {
    const MapSummary summary = map(model, true);
    EXPECT_EQ(summary.device, "host");
    EXPECT_EQ(summary.host_verified, 3U);
    EXPECT_THAT(summary.notice, StartsWith(refused() + "kernel"));
    EXPECT_THAT(summary.notice, ::testing::EndsWith(": sample 3 gave [1, 2]"));
    EXPECT_THAT([&] { map(model, true, "0"); },
                ::testing::ThrowsMessage<Error>(StartsWith("`device` 0: " + refused() + "kernel")));
  }
  const OctreeSummary summary = OctreeBuilder(bent(), octree).build();
  EXPECT_EQ(summary.device, "host");
  EXPECT_THAT(summary.notice, StartsWith(refused() + "octree"));
  octree.device = "0";
  EXPECT_THAT([&] { OctreeBuilder(bent(), octree); },
              ::testing::ThrowsMessage<Error>(StartsWith("`device` 0: refused")));
}

/// Depths have a program of their own, which is made ready in the midst of a map.
TEST_F(SampledKernelsTest, WhatFailsInTheMidstOfAMapProvesNothing) {
  static_cast<void>(map(two(), true));
  fail_all();
  const MapSummary in_memory = map(one(), true);
  EXPECT_EQ(in_memory.device, "host");
  EXPECT_EQ(in_memory.host_verified, 3U) << "all rows again";
  EXPECT_THAT(in_memory.notice, StartsWith(refused() + "kernels of points"));
  const std::vector<Point> points{{3.0, 0.0, 0.0}, {0.1, 0.05, 0.0}};
  EXPECT_THAT([&] { static_cast<void>(oracle::map_in_memory(one(), points, options())); },
              ::testing::ThrowsMessage<Error>(::testing::EndsWith("the map has begun by then: give `device` host")));
}

/// The search of unions is one more such program: without it the host searches.
TEST_F(SampledKernelsTest, WithoutASearchTheHostSearches) {
  const std::vector<Point> points(1100, Point{0.45, 0.05, 0.0});
  std::vector<MapResult> rows(points.size());
  static_cast<void>(PointMapper(two(), options()).map(points, rows));
  ASSERT_EQ(keys(outcomes).size(), 2U);
  for (const std::string& key : keys(outcomes))
    if (key.find("own tree") != std::string::npos) store_in_cache(key, "failed: sample 3 gave [1, 2]");
  const MapSummary summary = PointMapper(two(), options()).map(points, rows);
  EXPECT_EQ(summary.host_verified + summary.device_verified, points.size());
  EXPECT_GT(summary.host_verified, 0U);
  EXPECT_THAT(summary.notice, StartsWith(refused() + "kernels of a model's own tree"));
}

/// PoCL would end the process: it links kernels by a program of its own.
TEST_F(DeviceCacheTest, WithoutALinkerPoclIsPassedOver) {
  const cl::Platform platform(device().getInfo<CL_DEVICE_PLATFORM>());
  if (platform.getInfo<CL_PLATFORM_NAME>() != "Portable Computing Language") GTEST_SKIP() << "of PoCL alone";
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const Selection chosen = select_device("auto");
  EXPECT_FALSE(chosen.device);
  EXPECT_THAT(chosen.notice, ::testing::HasSubstr("PoCL links kernels by ld, which is not in PATH"));
  try {
    static_cast<void>(select_device("0"));
    ADD_FAILURE() << "the device was taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), StartsWith("`device` 0: "));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("by ld, which"));
  }
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace verisq::device
