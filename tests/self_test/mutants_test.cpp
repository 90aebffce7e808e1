/// Kernels broken in one place are refused by the self-test of their program, before a map is made with them.
///
/// Asked of gross mutants of each file. Finer ones often are not: what they get wrong is met by few queries, or is far
/// below the width of enclosures. VERISQ_SELF_TEST_MUTANTS says how many of each table, spread over it, are tried as
/// well, and counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/program_self_test.hpp"
#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/mutation/compiled_kernels.hpp"
#include "tests/mutation/mutant.hpp"
#include "tests/mutation/set_judge.hpp"
#include "tests/mutation/solid_judge.hpp"

namespace verisq::mutation {
namespace {

using FirstFault = std::function<std::string(const std::string& sources)>;

class MutantRefusalTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!selection_.device) GTEST_SKIP() << "no OpenCL device: " << selection_.notice;
  }

  [[nodiscard]] const device::Device& device() const { return *selection_.device; }

  /// Expects the true kernels to pass and the mutants of these names to be refused; prints how many others are.
  static void expect_refused(std::span<const Mutant> mutants, const std::set<std::string_view>& gross,
                             const std::string& sources, const FirstFault& first_fault) {
    EXPECT_EQ(first_fault(sources), "") << "the true kernels";
    std::size_t tried = 0;
    for (const Mutant& mutant : mutants) {
      if (!gross.contains(mutant.name)) continue;
      ++tried;
      EXPECT_NE(first_fault(mutated(sources, mutant)), "") << mutant.name;
    }
    EXPECT_EQ(tried, gross.size());
    count_refused(mutants, sources, first_fault);
  }

  static void count_refused(std::span<const Mutant> mutants, const std::string& sources,
                            const FirstFault& first_fault) {
    std::vector<Mutant> usual;
    for (const Mutant& mutant : mutants)
      if (mutant.shown_on == Arithmetic::usual) usual.push_back(mutant);
    const std::size_t count = std::min(usual.size(), oracle::requested_count("VERISQ_SELF_TEST_MUTANTS", 0));
    std::size_t refused = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const Mutant& mutant = usual[n * usual.size() / count];
      const std::string found = first_fault(mutated(sources, mutant));
      fmt::print("{:<52} {}\n", mutant.name, found.empty() ? "NOT REFUSED" : found);
      if (!found.empty()) ++refused;
    }
    if (count > 0) fmt::print("{} of {} refused\n", refused, count);
  }

  [[nodiscard]] FirstFault of_points() const {
    return [this](const std::string& sources) {
      const CompiledKernels kernels = compiled(device(), sources);
      return device::first_fault_in_steps(kernels, kernels.program);
    };
  }

  [[nodiscard]] FirstFault of_tapered_points() const {
    const CompiledKernels untapered = compiled(device(), std::string(kernels::embedded_point_sources()));
    return [this, untapered](const std::string& sources) {
      const CompiledKernels kernels = compiled(device(), sources);
      device::PointPrograms programs(untapered.program);
      programs.tapered = kernels.program;
      return device::first_fault_in_steps(kernels, programs);
    };
  }

  /// Tries a model's own program, whose sources lack those of set_bounds.cl unless `complete`.
  [[nodiscard]] FirstFault of_solid(const Model& model, bool complete) const {
    constexpr int children = 8;
    const CompiledKernels untapered = compiled(device(), std::string(kernels::embedded_point_sources()), children);
    const CompiledKernels tapered = compiled(device(), std::string(kernels::embedded_tapered_sources()), children);
    return [this, model, complete, untapered, tapered](const std::string& sources) {
      const std::string all = complete ? sources : sources + std::string(kernels::embedded_set_bounds());
      const CompiledKernels kernels = compiled(device(), all, children);
      device::PointPrograms convex(untapered.program);
      convex.tapered = tapered.program;
      return device::first_fault_of_solid(kernels, {kernels.program, convex}, model);
    };
  }

 private:
  const device::Selection selection_ = device::select_device("auto");
};

std::string solid_sources(const Model& model, std::string_view bent_distance) {
  return device::model_source(model, std::string(bent_distance).append(kernels::embedded_solid_distance()));
}

TEST_F(MutantRefusalTest, RowsInSteps) {
  expect_refused(row_mutants(), {"columns: not scaled"}, std::string(kernels::embedded_point_sources()), of_points());
}

TEST_F(MutantRefusalTest, RowsAtOnce) {
  const FirstFault fault = [this](const std::string& sources) {
    const CompiledKernels kernels = compiled(device(), sources);
    return device::first_fault_at_once(kernels, kernels.program, false);
  };
  expect_refused(point_map_mutants(), {"another point's vector", "one end alone", "only the last vector is told of"},
                 std::string(kernels::embedded_point_map()), fault);
}

TEST_F(MutantRefusalTest, ConvexPoints) {
  std::vector<Mutant> all;
  for (const Layer& layer : layers())
    if (!layer.is_arithmetic) all.insert(all.end(), layer.mutants.begin(), layer.mutants.end());
  expect_refused(all, {"rotation transposed", "another lane's point", "distance from the box's far side"},
                 std::string(kernels::embedded_point_sources()), of_points());
}

TEST_F(MutantRefusalTest, TaperedPoints) {
  const std::string sources(kernels::embedded_tapered_sources());
  const FirstFault fault = of_tapered_points();
  expect_refused(tapered_mutants(), {"focus on the other side", "apart without z"}, sources, fault);
  count_refused(tapered_interior_mutants(), sources, fault);
}

TEST_F(MutantRefusalTest, Triangles) {
  const FirstFault fault = [this](const std::string& sources) {
    const CompiledKernels kernels = compiled(device(), sources);
    return device::first_fault_of_triangles(kernels, kernels.program);
  };
  expect_refused(triangle_mutants(), {"least_or_nan takes the greater"},
                 std::string(kernels::embedded_triangle_sources()), fault);
}

TEST_F(MutantRefusalTest, Pairs) {
  const FirstFault fault = [this](const std::string& sources) {
    const CompiledKernels kernels = compiled(device(), sources);
    return device::first_fault_of_poses(kernels, kernels.program, device::pose_distances_by_host);
  };
  expect_refused(pair_mutants(), {"rotation of B transposed", "support of B by signed v"},
                 std::string(kernels::embedded_pair_sources()), fault);
}

TEST_F(MutantRefusalTest, BentSolids) {
  const Model model = solid_scenes().front().model;
  const std::string sources = solid_sources(model, kernels::embedded_bent_distance());
  const FirstFault fault = of_solid(model, false);
  expect_refused(solid_mutants(), {"unbend, m the wrong way"}, sources, fault);
  count_refused(depth_mutants(), sources, fault);
}

TEST_F(MutantRefusalTest, TaperedBentSolids) {
  const Model model = tapered_solid_scenes().front().model;
  const std::string sources = solid_sources(model, kernels::embedded_tapered_bent_distance());
  const FirstFault fault = of_solid(model, false);
  expect_refused(tapered_bent_mutants(), {"cubes of bends about the centre"}, sources, fault);
  count_refused(tapered_depth_mutants(), sources, fault);
}

TEST_F(MutantRefusalTest, SetOperations) {
  const Model model = set_scenes().front().model;
  expect_refused(set_mutants(), {}, device::solid_source(model), of_solid(model, true));
}

}  // namespace
}  // namespace verisq::mutation
