/// What runs remember of devices: programs, which no damage keeps from being compiled again, and outcomes of the
/// self-test, which hold for one binary alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "host/arithmetic/self_test.hpp"
#include "host/device/device.hpp"
#include "host/opencl/cache.hpp"
#include "host/opencl/program.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verisq/device.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

using ::testing::StartsWith;

/// A cache of its own, empty for each test. Drivers keep theirs beside it, and look for it once: there it stays.
class DeviceCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
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

}  // namespace
}  // namespace verisq::device
