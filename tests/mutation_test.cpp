/// Kernels broken in one place are found out, every one: by the device's self-test, by a bound on the wrong side of
/// what it bounds, or because `check` does not prove the map that they make.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "host/device/self_test.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/bound_judge.hpp"
#include "tests/mutation/map_judge.hpp"
#include "tests/mutation/mutant.hpp"
#include "tests/mutation/pessimistic_arithmetic.hpp"
#include "tests/mutation/scenes.hpp"

namespace verisq::mutation {
namespace {

std::string true_sources() {
  return std::string(kernels::embedded_sources());
}

/// Everything that may find a mutant out.
class Judges {
 public:
  Judges(const device::Device& device, bool with_self_test)
      : device_(device), with_self_test_(with_self_test), maps_(scenes()) {}

  /// What finds the kernels of `sources` out, on one of the arithmetics; empty where nothing does.
  [[nodiscard]] std::string operator()(const std::string& sources, Arithmetic first = Arithmetic::usual) {
    std::string found = fault(first, sources);
    for (const Arithmetic arithmetic : arithmetics)
      if (found.empty() && arithmetic != first) found = fault(arithmetic, sources);
    return found;
  }

 private:
  [[nodiscard]] device::Device compiled_on(Arithmetic arithmetic, const std::string& sources) const {
    return compiled(device_, with_bound_kernel(on(arithmetic, sources)));
  }

  [[nodiscard]] std::string fault(Arithmetic arithmetic, const std::string& sources) {
    const device::Device kernels = compiled_on(arithmetic, sources);
    if (with_self_test_ && arithmetic == Arithmetic::usual) {
      const std::string failure =
          device::self_test(kernels.context, kernels.device, kernels.program, kernels.vector_width);
      if (!failure.empty()) return "self-test: " + failure;
    }
    const std::string violated = bounds_(kernels);
    if (!violated.empty()) return fmt::format("bound, {}: {}", name_of(arithmetic), violated);
    const auto [false_rows, unproved_rows, first] = maps_(kernels, true_maps(arithmetic));
    if (false_rows > 0) {
      EXPECT_EQ(unproved_rows, false_rows) << "check proves what is false: " << first;
      return fmt::format("check, {}: {} false rows, {} not proved; {}", name_of(arithmetic), false_rows, unproved_rows,
                         first);
    }
    return unproved_rows > 0 ? fmt::format("check, {}: not proved; {}", name_of(arithmetic), first) : "";
  }

  const std::vector<MapJudge::AcceptedMap>& true_maps(Arithmetic arithmetic) {
    const auto [at, is_new] = true_maps_.try_emplace(arithmetic);
    if (is_new) at->second = maps_.accepted(compiled_on(arithmetic, true_sources()));
    return at->second;
  }

  device::Device device_;
  bool with_self_test_;
  MapJudge maps_;
  BoundJudge bounds_;
  std::map<Arithmetic, std::vector<MapJudge::AcceptedMap>> true_maps_;
};

class MutationTest : public testing::TestWithParam<Layer> {
 protected:
  void SetUp() override {
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
  }

  const device::Selection selection = device::select_device("auto");
};

TEST_P(MutationTest, AllAreKilled) {
  const auto& [name, is_arithmetic, mutants] = GetParam();
  Judges judges(*selection.device, is_arithmetic);
  std::size_t killed = 0;
  for (const Mutant& mutant : mutants) {
    const std::string found = judges(mutated(true_sources(), mutant), mutant.shown_on);
    fmt::print("{:<52} {}\n", mutant.name, found.empty() ? "SURVIVES" : found);
    std::fflush(stdout);
    killed += found.empty() ? 0 : 1;
    EXPECT_NE(found, "") << mutant.name;
  }
  fmt::print("{}: {} of {} mutants killed\n", name, killed, mutants.size());
}

INSTANTIATE_TEST_SUITE_P(Kernels, MutationTest, testing::ValuesIn(layers().begin(), layers().end()),
                         [](const auto& test) {
                           return std::string(test.param.name.substr(0, test.param.name.find('.')));
                         });

/// What the verdicts on mutants rest on: nothing is found where nothing is wrong.
TEST_F(MutationTest, TheTrueKernelsPass) {
  Judges judges(*selection.device, true);
  EXPECT_EQ(judges(true_sources()), "");
}

}  // namespace
}  // namespace verisq::mutation
