/// `verisq-mpi`, where it is built and mpirun is there: the bytes of one process on any number of ranks, and after a
/// kill.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

const std::string model = VERISQ_EXAMPLES "/stem_mm.json";

class MpiProgram : public ProgramTest {
 protected:
  void SetUp() override {
    if (std::string(VERISQ_MPI_PROGRAM).empty()) GTEST_SKIP() << "built without MPI";
    if (!std::filesystem::exists("/usr/bin/mpirun")) GTEST_SKIP() << "no mpirun";
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> coordinate(-250.0, 250.0);
    std::string text;
    for (int i = 0; i < 30'000; ++i) {
      text += std::to_string(coordinate(generator)) + "," + std::to_string(coordinate(generator)) + "," +
              std::to_string(coordinate(generator)) + "\n";
    }
    (void)write("points.csv", text);
    for (const char* const name : {"one.npy", "one.csv"}) {
      ASSERT_EQ(
          run({"map", "--model", model, "--points", path("points.csv"), "-o", path(name), "--device", "host"}).status,
          0);
    }
  }

  [[nodiscard]] Process job_of(int ranks, const Arguments& options) const {
    Arguments arguments{"/usr/bin/mpirun",     "--allow-run-as-root", "--oversubscribe", "-n",
                        std::to_string(ranks), VERISQ_MPI_PROGRAM,    "--model",         model};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return {arguments, folder_.path()};
  }

  [[nodiscard]] Process job(int ranks, const std::string& output, const Arguments& more = {}) const {
    Arguments options{"--points", path("points.csv"), "-o", path(output), "--device", "host"};
    options.insert(options.end(), more.begin(), more.end());
    return job_of(ranks, options);
  }

  /// Killed as soon as it has begun to compute; on a busy machine it may be done by then.
  void start_and_kill(const std::string& output) const {
    std::filesystem::remove(path(output));
    const Process killed = job(2, output);
    while (!std::filesystem::exists(path(output + ".job")) && !std::filesystem::exists(path(output))) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    killed.send(SIGTERM);
    (void)killed.wait();
  }
};

TEST_F(MpiProgram, WritesTheBytesOfOneProcessOnAnyNumberOfRanks) {
  for (const int ranks : {1, 3}) {
    for (const std::string extension : {".npy", ".csv"}) {
      const Outcome outcome = job(ranks, "map" + extension).wait();
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("points             30000\n"));
      EXPECT_TRUE(contents(path("map" + extension)) == contents(path("one" + extension))) << ranks << extension;
      EXPECT_FALSE(std::filesystem::exists(path("map" + extension + ".job")));
      EXPECT_FALSE(std::filesystem::exists(path("map" + extension + ".rows")));
    }
  }
}

TEST_F(MpiProgram, MapsTrianglesAndUncertainPlaces) {
  const std::string mesh = VERISQ_EXAMPLES "/cavity.off";
  const Arguments triangles{"--mesh", mesh, "--on", "triangles", "--tol", "1"};
  const Arguments places{"--mesh", mesh, "--translation-error", "0.5", "--rotation-error", "0.5", "--tol", "9"};
  for (const Arguments& subject : {triangles, places}) {
    for (const char* const extension : {".npy", ".csv"}) {
      const std::string alone = path(std::string("alone") + extension);
      const std::string shared = path(std::string("shared") + extension);
      Arguments map{"map", "--model", model, "--device", "host", "-o", alone};
      map.insert(map.end(), subject.begin(), subject.end());
      EXPECT_EQ(run(map).status, 0);
      Arguments options{"--device", "host", "-o", shared};
      options.insert(options.end(), subject.begin(), subject.end());
      const Outcome outcome = job_of(2, options).wait();
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_TRUE(contents(shared) == contents(alone)) << extension;
    }
  }
}

TEST_F(MpiProgram, GoesOnWhereAKilledJobStopped) {
  constexpr int attempts = 10;  // see start_and_kill
  const auto stopped = [&] {
    return std::filesystem::exists(path("map.npy.job")) && !std::filesystem::exists(path("map.npy"));
  };
  for (int i = 0; i < attempts && !stopped(); ++i) start_and_kill("map.npy");
  ASSERT_TRUE(stopped()) << "the job was done before it was killed";
  EXPECT_NE(job(1, "map.npy", {"--resume", "--tol", "0.5"}).wait().status, 0);
  EXPECT_FALSE(std::filesystem::exists(path("map.npy")));
  const Outcome outcome = job(3, "map.npy", {"--resume"}).wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contents(path("map.npy")) == contents(path("one.npy")));
}

TEST_F(MpiProgram, RefusesWhatCannotBe) {
  const auto refused = [&](const Process& process, const std::string& words) {
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  refused(job(2, "map.npy", {"--resume"}), "there is no job to go on with");
  refused(job(2, "map.vtp"), ".csv and .npy only");
  refused(job(2, "map.npy", {"--on", "triangles"}), "give their --mesh");
}

}  // namespace
}  // namespace verisq::testing
