/// Kernels broken in one place are found out, every one: by the device's self-test, by a bound on the wrong side of
/// what it bounds, or because `check` does not prove the map that they make.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "host/device/sample_operations.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/kernels/point_map_judge.hpp"
#include "tests/kernels/row_judge.hpp"
#include "tests/mutation/bound_judge.hpp"
#include "tests/mutation/depth_judge.hpp"
#include "tests/mutation/gauge_square.hpp"
#include "tests/mutation/map_judge.hpp"
#include "tests/mutation/mutant.hpp"
#include "tests/mutation/pair_judge.hpp"
#include "tests/mutation/pessimistic_arithmetic.hpp"
#include "tests/mutation/scenes.hpp"
#include "tests/mutation/set_judge.hpp"
#include "tests/mutation/solid_judge.hpp"
#include "tests/mutation/tapered_cube_judge.hpp"
#include "tests/mutation/tapered_interior_judge.hpp"
#include "tests/mutation/tapered_judge.hpp"
#include "tests/mutation/triangle_judge.hpp"
#include "tests/mutation/unbent_judge.hpp"

namespace verisq::mutation {
namespace {

std::string true_sources() {
  return std::string(kernels::embedded_point_sources()).append(kernels::embedded_self_test());
}

/// Everything that may find a mutant out.
class Judges {
 public:
  Judges(const device::Device& device, bool with_self_test)
      : device_(device), with_self_test_(with_self_test), maps_(scenes()) {}

  /// What finds the kernels of `sources` out, on one of the arithmetics; empty where nothing does.
  [[nodiscard]] std::string operator()(const std::string& sources, Arithmetic first = Arithmetic::usual) {
    std::string found = fault(first, sources);
    for (const Arithmetic arithmetic : arithmetics(Program::points))
      if (found.empty() && arithmetic != first) found = fault(arithmetic, sources);
    return found;
  }

 private:
  [[nodiscard]] CompiledKernels compiled_on(Arithmetic arithmetic, const std::string& sources) const {
    return compiled(device_, with_bound_kernel(on(arithmetic, Program::points, sources)));
  }

  [[nodiscard]] std::string fault(Arithmetic arithmetic, const std::string& sources) {
    const CompiledKernels kernels = compiled_on(arithmetic, sources);
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

class MutationTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
  }

  const device::Selection selection = device::select_device("auto");
};

class LayerMutationTest : public MutationTest, public testing::WithParamInterface<Layer> {};

/// `find` says what finds the kernels of some sources out; the argument after them is where to look first.
using Find = std::function<std::string(const std::string& sources, Arithmetic first)>;

void expect_all_killed(std::string_view name, std::span<const Mutant> mutants, const std::string& sources,
                       const Find& find) {
  std::size_t killed = 0;
  for (const Mutant& mutant : mutants) {
    const std::string found = find(mutated(sources, mutant), mutant.shown_on);
    fmt::print("{:<52} {}\n", mutant.name, found.empty() ? "SURVIVES" : found);
    std::fflush(stdout);
    killed += found.empty() ? 0 : 1;
    EXPECT_NE(found, "") << mutant.name;
  }
  fmt::print("{}: {} of {} mutants killed\n", name, killed, mutants.size());
}

TEST_P(LayerMutationTest, AllAreKilled) {
  const auto& [name, is_arithmetic, mutants] = GetParam();
  Judges judges(*selection.device, is_arithmetic);
  expect_all_killed(name, mutants, true_sources(), std::ref(judges));
}

INSTANTIATE_TEST_SUITE_P(Kernels, LayerMutationTest, testing::ValuesIn(layers().begin(), layers().end()),
                         [](const auto& test) {
                           return std::string(test.param.name.substr(0, test.param.name.find('.')));
                         });

/// What the verdicts on mutants rest on: nothing is found where nothing is wrong.
TEST_F(MutationTest, TheTrueKernelsPass) {
  Judges judges(*selection.device, true);
  EXPECT_EQ(judges(true_sources()), "");
}

/// Triangles, pairs and solids: by a false enclosure, triangles also by a certificate that `check` does not accept,
/// solids by a false claim about a cube.
class ConvexMutationTest : public MutationTest {
 protected:
  [[nodiscard]] CompiledKernels compiled_on(Arithmetic arithmetic, Program program, const std::string& sources) const {
    return compiled(*selection.device, on(arithmetic, program, sources));
  }

  /// The first fault that `fault(arithmetic, sources)` tells, on `first` and then on the others.
  template <class Fault>
  static std::string first_fault(Program program, Arithmetic first, const std::string& sources, const Fault& fault) {
    std::string found = fault(first, sources);
    for (const Arithmetic arithmetic : arithmetics(program))
      if (found.empty() && arithmetic != first) found = fault(arithmetic, sources);
    return found;
  }

  [[nodiscard]] Find triangle_faults(const TriangleJudge& judge) const {
    const CompiledKernels true_kernels = compiled_on(Arithmetic::usual, Program::triangles, triangle_sources);
    return [this, &judge, true_kernels](const std::string& sources, Arithmetic first) {
      return first_fault(Program::triangles, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const CompiledKernels kernels = compiled_on(arithmetic, Program::triangles, text);
        const std::string found = judge.false_claim(kernels);
        if (!found.empty()) return fmt::format("{}: {}", name_of(arithmetic), found);
        if (arithmetic != Arithmetic::usual) return std::string();
        const std::string unproved = judge.unproved_row(kernels, true_kernels);
        return unproved.empty() ? unproved : "check: " + unproved;
      });
    };
  }

  [[nodiscard]] Find pair_faults(const PairJudge& judge) const {
    return [this, &judge](const std::string& sources, Arithmetic first) {
      return first_fault(Program::pairs, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const std::string found = judge.false_claim(compiled_on(arithmetic, Program::pairs, text));
        return found.empty() ? found : fmt::format("{}: {}", name_of(arithmetic), found);
      });
    };
  }

  template <class Judge>
  [[nodiscard]] Find tapered_faults(const Judge& judge, Program program = Program::tapered_points) const {
    return [this, &judge, program](const std::string& sources, Arithmetic first) {
      return first_fault(program, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const std::string found = judge.false_claim(compiled_on(arithmetic, program, text));
        return found.empty() ? found : fmt::format("{}: {}", name_of(arithmetic), found);
      });
    };
  }

  [[nodiscard]] Find solid_faults(const SolidJudge& judge, Program program) const {
    return [this, &judge, program](const std::string& sources, Arithmetic first) {
      return first_fault(program, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const CompiledKernels kernels = compiled_on(arithmetic, program, text);
        const std::string found = judge.false_claim(kernels, arithmetic == Arithmetic::usual);
        return found.empty() ? found : fmt::format("{}: {}", name_of(arithmetic), found);
      });
    };
  }

  [[nodiscard]] Find set_faults(const SetJudge& judge) const {
    return [this, &judge](const std::string& sources, Arithmetic first) {
      return first_fault(Program::set_bounds, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const std::string found = judge.false_claim(compiled_on(arithmetic, Program::set_bounds, text));
        return found.empty() ? found : fmt::format("{}: {}", name_of(arithmetic), found);
      });
    };
  }

  [[nodiscard]] Find depth_faults(const DepthJudge& judge) const {
    return [this, &judge](const std::string& sources, Arithmetic first) {
      return first_fault(Program::bent_depths, first, sources, [&](Arithmetic arithmetic, const std::string& text) {
        const std::string found = judge.false_claim(compiled_on(arithmetic, Program::bent_depths, text));
        return found.empty() ? found : fmt::format("{}: {}", name_of(arithmetic), found);
      });
    };
  }

  const std::string triangle_sources{kernels::embedded_triangle_sources()};
  const std::string pair_sources{kernels::embedded_pair_sources()};
};

TEST_F(ConvexMutationTest, AllOfRowsAreKilled) {
  const std::string sources(kernels::embedded_point_sources());
  const Find find = [this](const std::string& text, Arithmetic /*any*/) {
    const CompiledKernels kernels = compiled(*selection.device, text);
    const std::string found = device::false_columns(kernels, kernels.program);
    return found.empty() ? device::false_rows(kernels, kernels.program) : found;
  };
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("row_verdict.clh, point_rows.cl", row_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfMapsInOneStepAreKilled) {
  const std::string sources(kernels::embedded_point_map());
  const Find find = [this](const std::string& text, Arithmetic /*any*/) {
    const CompiledKernels kernels = compiled(*selection.device, text);
    return device::false_point_map(kernels, kernels.program);
  };
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernel";
  expect_all_killed("point_map.cl", point_map_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfTaperedPointsAreKilled) {
  const TaperedJudge judge;
  const Find find = tapered_faults(judge);
  const std::string sources = TaperedJudge::sources();
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("primitive.clh, tapered_enclosure.clh", tapered_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfPointsInsideTaperedOnesAreKilled) {
  const TaperedInteriorJudge judge;
  const Find find = tapered_faults(judge);
  const std::string sources = std::string(kernels::embedded_tapered_sources()) + TaperedInteriorJudge::examination();
  for (const Arithmetic arithmetic : arithmetics(Program::tapered_points))
    EXPECT_EQ(find(sources, arithmetic), "") << "the true kernels";
  expect_all_killed("tapered_interior.clh, interior_depth.cl", tapered_interior_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfTaperedCubesAreKilled) {
  const TaperedCubeJudge judge;
  const Find find = tapered_faults(judge, Program::tapered_cubes);
  const std::string sources = TaperedCubeJudge::sources();
  for (const Arithmetic arithmetic : arithmetics(Program::tapered_cubes))
    EXPECT_EQ(find(sources, arithmetic), "") << "the true kernels";
  const auto shares = judge.shares(compiled_on(Arithmetic::usual, Program::tapered_cubes, sources));
  fmt::print("told: {:.3f} of colours, {:.3f} of half-spaces\n", shares.colours, shares.half_spaces);
  EXPECT_GT(shares.colours, 0.5);
  EXPECT_GT(shares.half_spaces, 0.9);
  expect_all_killed("tapered_box_gauge.clh", tapered_cube_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfTrianglesAreKilled) {
  const TriangleJudge judge(triangle_scenes());
  const Find find = triangle_faults(judge);
  EXPECT_EQ(find(triangle_sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("triangle_distance.cl", triangle_mutants(), triangle_sources, find);
}

TEST_F(ConvexMutationTest, AllOfPairsAreKilled) {
  const PairJudge judge(pair_scenes());
  const Find find = pair_faults(judge);
  EXPECT_EQ(find(pair_sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("pair_distance.cl", pair_mutants(), pair_sources, find);
}

TEST_F(ConvexMutationTest, AllOfSolidsAreKilled) {
  const SolidJudge judge(solid_scenes());
  const Find find = solid_faults(judge, Program::solids);
  const std::string sources = judge.sources();
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("solid_distance.cl", solid_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfTaperedBentSolidsAreKilled) {
  const UnbentJudge unbent;
  const SolidJudge judge(tapered_solid_scenes());
  const Find of_functions = tapered_faults(unbent, Program::tapered_solids);
  const Find of_solids = solid_faults(judge, Program::tapered_solids);
  const Find find = [&](const std::string& sources, Arithmetic first) {
    const std::string found = of_functions(sources, first);
    return found.empty() ? of_solids(sources, first) : found;
  };
  const std::string sources = judge.sources() + UnbentJudge::examination();
  for (const Arithmetic arithmetic : arithmetics(Program::tapered_solids))
    EXPECT_EQ(find(sources, arithmetic), "") << "the true kernels";
  expect_all_killed("tapered_unbent_solid.clh", tapered_bent_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfSetBoundsAreKilled) {
  const SetJudge judge(set_scenes());
  const Find find = set_faults(judge);
  const std::string sources = SetJudge::sources();
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  expect_all_killed("set_bounds.cl", set_mutants(), sources, find);
}

/// What the judge of depths compares with.
template <class Function>
void expect_derivatives_of_differences(double taper) {
  constexpr Long step = 1e-4L;
  for (const auto& exponents : {std::array{1.0, 1.0}, std::array{0.3, 0.7}, std::array{0.8, 0.25}}) {
    const Function gauge({{0.7, 0.4, 1.3}, exponents, taper});
    for (const LongVector& x :
         {LongVector{0.3L, 0.2L, 0.9L}, LongVector{0.5L, 0.35L, 0.4L}, LongVector{0.1L, 0.3L, 1.1L}}) {
      const LongVector gradient = gauge.gradient(x);
      const LongMatrix second = gauge.second_derivative(x);
      for (std::size_t i = 0; i < 3; ++i) {
        LongVector up = x;
        LongVector down = x;
        up[i] += step;
        down[i] -= step;
        const Long slope = (gauge.value(up) - gauge.value(down)) / (2 * step);
        EXPECT_NEAR(static_cast<double>(gradient[i]), static_cast<double>(slope), 1e-5);
        for (std::size_t j = 0; j < 3; ++j) {
          const Long change = (gauge.gradient(up)[j] - gauge.gradient(down)[j]) / (2 * step);
          EXPECT_NEAR(static_cast<double>(second[i][j]), static_cast<double>(change), 1e-4) << i << j;
        }
      }
      const LargestStep largest = largest_step(second, 0.7L);
      const auto& [a, b, c] = largest.step;
      EXPECT_NEAR(static_cast<double>(a * a + b * b + 0.49L * c * c), 1.0, 1e-12);
    }
  }
}

TEST(GaugeSquareTest, DerivativesAreThoseOfDifferences) {
  expect_derivatives_of_differences<GaugeSquare>(1.0);
}

TEST(SectionProfileTest, DerivativesAreThoseOfDifferences) {
  for (const double taper : {1.0, 1.5, 3.0}) expect_derivatives_of_differences<SectionProfile>(taper);
}

TEST_F(ConvexMutationTest, AllOfBentDepthsAreKilled) {
  const DepthJudge judge(Tapers::none);
  const Find find = depth_faults(judge);
  const std::string sources = judge.sources();
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  const DepthJudge::Shares shares = judge.shares(compiled_on(Arithmetic::usual, Program::bent_depths, sources));
  fmt::print("claimed: {:.3f} of metrics, {:.3f} and {:.3f} of balls, {:.3f} of depths\n", shares.metrics, shares.balls,
             shares.balls_by_profile, shares.depths);
  EXPECT_GT(shares.metrics, 0.3);
  EXPECT_GT(shares.balls, 0.3);
  EXPECT_GT(shares.balls_by_profile, 0.3);
  EXPECT_GT(shares.depths, 0.3);
  expect_all_killed("bent_depth.clh", depth_mutants(), sources, find);
}

TEST_F(ConvexMutationTest, AllOfTaperedBentDepthsAreKilled) {
  const DepthJudge judge(Tapers::some);
  const Find find = depth_faults(judge);
  const std::string sources = judge.sources();
  EXPECT_EQ(find(sources, Arithmetic::usual), "") << "the true kernels";
  const DepthJudge::Shares shares = judge.shares(compiled_on(Arithmetic::usual, Program::bent_depths, sources));
  fmt::print("claimed: {:.3f} of balls, {:.3f} of depths\n", shares.balls_by_profile, shares.depths);
  EXPECT_GT(shares.balls_by_profile, 0.3);
  EXPECT_GT(shares.depths, 0.3);
  expect_all_killed("bent_depth.clh about tapered solids", tapered_depth_mutants(), sources, find);
}

}  // namespace
}  // namespace verisq::mutation
