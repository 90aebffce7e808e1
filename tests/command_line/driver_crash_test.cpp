/// A damaged cache of PoCL ends no command: it starts again on the host, or says why it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "host/device/device.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

bool pocl_is_there() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return false;
  }
  return platforms.size() == 1 && platforms.front().getInfo<CL_PLATFORM_NAME>() == "Portable Computing Language";
}

/// With a cache of its own, whose compiled kernels are garbage.
class DriverCrash : public testing::ProgramTest {
 protected:
  void SetUp() override {
    if (!pocl_is_there()) GTEST_SKIP() << "of PoCL alone";
    setenv("XDG_CACHE_HOME", path("cache").c_str(), 1);
    ASSERT_EQ(run({"devices"}).status, 0);
    std::size_t damaged = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "cache/pocl")) {
      if (entry.path().extension() != ".so") continue;
      std::ofstream(entry.path()) << "no kernel";
      ++damaged;
    }
    ASSERT_GT(damaged, 0U);
    // Otherwise the self-test is not repeated, and its kernels not looked at.
    std::filesystem::remove_all(folder_ / "cache/verisq");
  }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  const std::string model_ = places::example("capsule.json");
  const std::string points_ = write("points.xyz", "2 0 0\n0 3 0\n");
};

TEST_F(DriverCrash, StartsAgainWithoutDevices) {
  const auto listed = run({"devices"});
  EXPECT_THAT(listed.err, HasSubstr("verisq: the OpenCL driver ended this run"));
  EXPECT_THAT(listed.err, HasSubstr("delete \"" + path("cache/pocl") + "\""));
  EXPECT_THAT(listed.err, HasSubstr("verisq: starting again without OpenCL devices"));
  EXPECT_THAT(listed.out + listed.err, HasSubstr("no OpenCL device"));
}

/// A limit of what may be written to a file stands for a full disk: PoCL prints LLVM's error and calls `exit`.
TEST_F(DriverCrash, StartsAgainWhereTheDiskIsFull) {
  std::filesystem::remove_all(folder_ / "cache");
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit few_bytes = {100'000, before.rlim_max};  // sources fit, compiled kernels do not
  setrlimit(RLIMIT_FSIZE, &few_bytes);
  const auto listed = run({"devices"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, signal_before);
  EXPECT_THAT(listed.err, HasSubstr("the disk is full"));
  EXPECT_THAT(listed.err, HasSubstr("verisq: starting again without OpenCL devices"));
}

TEST_F(DriverCrash, RefusesANamedDevice) {
  const auto mapped = run({"map", "--model", model_, "--points", points_, "-o", path("map.csv"), "--device", "0"});
  EXPECT_EQ(mapped.status, 2);
  EXPECT_THAT(mapped.err, HasSubstr("starting again"));
  EXPECT_THAT(mapped.err, HasSubstr("--device 0: no such device"));
  EXPECT_FALSE(std::filesystem::exists(path("map.csv")));
}

/// A pipe gives back neither what was written to it nor what was read from it.
TEST_F(DriverCrash, DoesNotUseAPipeTwice) {
  for (const std::string output : {"-o-", "--output=-", "--output=/dev/null"}) {
    const auto mapped =
        run({"map", "--model", model_, "--points", points_, output, "--format", "csv", "--device", "0"});
    EXPECT_EQ(mapped.status, 128 + SIGABRT) << mapped.err;
    EXPECT_THAT(mapped.err, HasSubstr("or give --device host"));
    EXPECT_THAT(mapped.err, Not(HasSubstr("starting again")));
  }
}

}  // namespace
}  // namespace verisq
