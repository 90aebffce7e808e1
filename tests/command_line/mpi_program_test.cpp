/// `verisq-mpi`, where it is built and mpirun is there: the bytes of one process on any number of ranks, and after a
/// kill; the tables of a cohort.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

const std::string model = places::example("stem_mm.json");

class MpiProgram : public ProgramTest {
 protected:
  void SetUp() override {
    if (places::mpi_program().empty()) GTEST_SKIP() << "built without MPI";
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

  [[nodiscard]] Process ranks_of(int ranks, const Arguments& words) const {
    Arguments arguments{"/usr/bin/mpirun",     "--allow-run-as-root", "--oversubscribe", "-n",
                        std::to_string(ranks), places::mpi_program()};
    arguments.insert(arguments.end(), words.begin(), words.end());
    return {arguments, folder_.path()};
  }

  [[nodiscard]] Process job_of(int ranks, const Arguments& options) const {
    Arguments arguments{"map", "--model", model};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return ranks_of(ranks, arguments);
  }

  [[nodiscard]] Process job(int ranks, const std::string& output, const Arguments& more = {}) const {
    Arguments options{"--points", path("points.csv"), "-o", path(output), "--device", "host"};
    options.insert(options.end(), more.begin(), more.end());
    return job_of(ranks, options);
  }

  [[nodiscard]] Process job_of_many(int ranks, const Arguments& more = {}) const {
    Arguments options{"--points", path("many.csv"), "-o", path("map.npy"), "--device", "host"};
    options.insert(options.end(), more.begin(), more.end());
    return job_of(ranks, options);
  }

  /// Killed as soon as it has begun to compute; on a busy machine it may be done by then.
  void start_and_kill() const {
    std::filesystem::remove(path("map.npy"));
    const Process killed = job_of_many(2);
    while (!std::filesystem::exists(path("map.npy.job")) && !std::filesystem::exists(path("map.npy"))) {
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
  const std::string mesh = places::example("cavity.off");
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
  constexpr int times = 8;
  std::string many;
  for (int i = 0; i < times; ++i) many += contents(path("points.csv"));
  (void)write("many.csv", many);
  ASSERT_EQ(
      run({"map", "--model", model, "--points", path("many.csv"), "-o", path("one.npy"), "--device", "host"}).status,
      0);
  const auto stopped = [&] {
    return std::filesystem::exists(path("map.npy.job")) && !std::filesystem::exists(path("map.npy"));
  };
  for (int i = 0; i < attempts && !stopped(); ++i) start_and_kill();
  ASSERT_TRUE(stopped()) << "the job was done before it was killed";
  EXPECT_NE(job_of_many(1, {"--resume", "--tol", "0.5"}).wait().status, 0);
  EXPECT_FALSE(std::filesystem::exists(path("map.npy")));
  const Outcome outcome = job_of_many(3, {"--resume"}).wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contents(path("map.npy")) == contents(path("one.npy")));
}

/// A bone of several blocks of vertices, about where a stem goes in.
std::string scattered_vertices() {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> coordinate(-40.0, 40.0);
  constexpr int count = 2500;
  std::string off = "OFF\n" + std::to_string(count) + " 0 0\n";
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) off += std::to_string(coordinate(generator)) + (k < 2 ? " " : "\n");
  }
  return off;
}

TEST_F(MpiProgram, SharesTheVerticesOfAWayIn) {
  const std::string bone = write("bone.off", scattered_vertices());
  const std::string poses = write("way.csv", "0,0,60,1,0,0,0\n5,0,20,0.99,0.1,0,0.05\n0,0,0,1,0,0,0\n");
  const Arguments straight{"--along", "0,0,-1", "--length", "40", "--turn", "5", "--tol", "3"};
  const Arguments bent{"--poses", poses, "--tol", "3"};
  for (const Arguments& way : {straight, bent}) {
    Arguments subject{"insert", "--implant", model, "--mesh", bone, "--device", "host"};
    subject.insert(subject.end(), way.begin(), way.end());
    for (const char* const extension : {".npy", ".csv"}) {
      Arguments alone = subject;
      alone.insert(alone.end(), {"-o", path(std::string("alone") + extension)});
      Arguments shared = subject;
      shared.insert(shared.end(), {"-o", path(std::string("shared") + extension)});
      const int status = run(alone).status;
      const Outcome outcome = ranks_of(3, shared).wait();
      EXPECT_EQ(outcome.status, status) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("points             2500\n"));
      EXPECT_THAT(outcome.out, HasSubstr("ranks              3, 3 chunks\n"));
      EXPECT_TRUE(contents(path(std::string("shared") + extension)) == contents(path(std::string("alone") + extension)))
          << extension;
    }
  }
}

/// Without the times.
std::string answers_in(const std::string& json) {
  nlohmann::json table = nlohmann::json::parse(json);
  for (nlohmann::json& result : table.at("results")) result.erase("seconds");
  return table.dump();
}

TEST_F(MpiProgram, SharesTheCasesOfACohort) {
  const std::string cavity = places::example("cavity.off");
  const std::string capsule = places::example("capsule.json");
  std::string manifest = "case,command,model,implant,mesh,a,b,tol,device,any-side,on,gap,samples,primitives,output\n";
  const std::string near = ",map," + model + ",," + cavity + ",,,1e-3,host,,,,,,\n";
  manifest += "near" + near + "nearer" + near;
  manifest += "fitted,fit,," + capsule + "," + cavity + ",,,1e-2,host,yes,vertices,2,16,,fitted.json\n";
  manifest += "recovered,recover,,," + cavity + ",,,,,,,,,1,recovered.json\n";
  manifest += "way,insert,," + model + "," + cavity + ",,,3,host,,,,,,way.npy\n";  // fails: no way
  manifest += "pair,distance,,,," + model + "," + model + ",1e-3,,,,,,,\n";
  manifest += "wide,map," + model + ",," + cavity + ",,,0,host,,,,,,\n";
  manifest += "missing,map," + model + ",,nothing.off,,,,,,,,,,\n";
  const std::string cohort = write("cohort.csv", manifest);
  const Outcome alone = run({"batch", cohort, "-o", path("alone"), "--no-progress"});
  const Outcome shared = ranks_of(3, {"batch", cohort, "-o", path("shared"), "--no-progress"}).wait();
  EXPECT_EQ(alone.status, 3) << alone.err;
  EXPECT_EQ(shared.status, 3) << shared.err;
  EXPECT_THAT(shared.out, HasSubstr("cases              8\n"));
  EXPECT_THAT(shared.out, HasSubstr("failed             missing: "));
  EXPECT_EQ(contents(path("shared/summary.csv")), contents(path("alone/summary.csv")));
  EXPECT_EQ(answers_in(contents(path("shared/summary.json"))), answers_in(contents(path("alone/summary.json"))));
  EXPECT_TRUE(contents(path("shared/maps/near.npy")) == contents(path("alone/maps/near.npy")));
  const Outcome again = ranks_of(2, {"batch", cohort, "-o", path("shared"), "--no-progress"}).wait();
  EXPECT_THAT(again.out, HasSubstr("taken over         6 of an earlier run\n"));
  EXPECT_EQ(contents(path("shared/summary.csv")), contents(path("alone/summary.csv")));
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
  refused(ranks_of(2, {"insert", "--implant", model, "--mesh", path("none.off"), "-o", path("way.npy")}),
          "give either --poses or --along");
  refused(ranks_of(2, {"batch", path("none.csv"), "-o", path("none")}), "none.csv");
}

}  // namespace
}  // namespace verisq::testing
