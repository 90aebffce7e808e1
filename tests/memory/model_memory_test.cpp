/// Models that do not fit into a device's constant memory are read from global memory, with the same results bit by
/// bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/octree.hpp>

#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/program_self_test.hpp"
#include "host/device/query_batches.hpp"
#include "host/maps/octree.hpp"
#include "host/plan/pose_search.hpp"
#include "tests/fixtures/random.hpp"
#include "verify/search/octree_cube.hpp"
#include "verisq/distance.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t queries = 200;

bool same_bits(std::span<const Enclosure> a, std::span<const Enclosure> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

Model three_primitives() {
  return {"",
          {{"one", {{1.0, 1.5, 0.6}, {1.0, 1.2}}, {}},
           {"other", {{0.4, 1.0, 1.2}, {0.5, 1.8}}, {{1.0, 0.0, 0.0}, {1.0, 1.0, 1.0, 1.0}}},
           {"third", {{0.4, 0.5, 0.6}, {0.3, 1.0}}, {{0.0, 1.5, 0.3}, {1.0, 0.2, 0.0, 0.0}}}}};
}

std::vector<Point> points(double reach) {
  testing::Random random(1);
  std::vector<Point> all(queries);
  for (Point& x : all) x = random.point(reach);
  return all;
}

struct Answers {
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> certificates;
};

template <class Query>
Answers answers(Batch<Query>& batch, std::span<const Query> asked) {
  Answers all;
  batch.submit(asked);
  batch.collect(all.enclosures, all.certificates);
  return all;
}

class ModelMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Selection selection = select_device("auto");
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
    device_ = selection.device;
    small_ = device_;
    small_->constant_memory = 2 * sizeof(PrimitiveParameters);
    ASSERT_EQ(model_memory_option(*device_, 3 * sizeof(PrimitiveParameters)), "");
    ASSERT_NE(model_memory_option(*small_, 3 * sizeof(PrimitiveParameters)), "");
  }

  std::optional<Device> device_;
  std::optional<Device> small_;  // as if its constant memory had no room for the model
};

TEST_F(ModelMemoryTest, IsTheDevicesLimit) {
  EXPECT_EQ(device_->constant_memory, device_->device.getInfo<CL_DEVICE_MAX_CONSTANT_BUFFER_SIZE>());
  EXPECT_EQ(model_memory_option(*small_, 2 * sizeof(PrimitiveParameters)), "");
  EXPECT_NE(model_memory_option(*small_, 2 * sizeof(PrimitiveParameters) + 1), "");
}

TEST_F(ModelMemoryTest, PointsGetTheSameBits) {
  const auto of = [](const Device& device) {
    return answers<Point>(*point_batch(device, three_primitives(), 1e-6, true), points(3.0));
  };
  const Answers constant = of(*device_);
  const Answers global = of(*small_);
  EXPECT_TRUE(same_bits(constant.enclosures, global.enclosures));
  EXPECT_EQ(constant.certificates, global.certificates);
}

TEST_F(ModelMemoryTest, TrianglesGetTheSameBits) {
  const std::vector<Point> corners = points(3.0);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); ++i)
    triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  const auto of = [&](const Device& device) {
    return answers<Triangle>(*triangle_batch(device, three_primitives(), true), triangles);
  };
  const Answers constant = of(*device_);
  const Answers global = of(*small_);
  EXPECT_TRUE(same_bits(constant.enclosures, global.enclosures));
  EXPECT_EQ(constant.certificates, global.certificates);
}

TEST_F(ModelMemoryTest, PosesGetTheSameBits) {
  testing::Random random(2);
  std::vector<Pose> poses(queries);
  for (Pose& pose : poses) {
    pose.translation = random.point(4.0);
    for (double& component : pose.quaternion) component = random.uniform(-1.0, 1.0);
  }
  const auto of = [&](const Device& device) {
    return answers<Pose>(*pose_batch(device, three_primitives(), three_primitives(), pose_distances_by_host), poses);
  };
  EXPECT_TRUE(same_bits(of(*device_).enclosures, of(*small_).enclosures));
}

Model bent_difference() {
  Model model = three_primitives();
  model.primitives.pop_back();
  model.primitives[0].bend = Bend{0.3, 20.0};
  SetExpression difference{{}, SetOperation::subtract, 0};
  for (const std::uint32_t i : {0U, 1U}) difference.operands.push_back({{}, SetOperation::unite, i});
  model.csg = difference;
  return model;
}

TEST_F(ModelMemoryTest, SolidsGetTheSameBits) {
  small_->constant_memory = sizeof(PrimitiveParameters);
  ASSERT_NE(model_memory_option(*small_, 2 * sizeof(BoxPrimitiveParameters)), "");
  const auto of = [](const Device& device) {
    return answers<Point>(*solid_batch(device, bent_difference(), 1e-3), points(2.0));
  };
  EXPECT_TRUE(same_bits(of(*device_).enclosures, of(*small_).enclosures));
}

TEST_F(ModelMemoryTest, OctreesGetTheSameCubes) {
  small_->constant_memory = 0;
  const Model model = bent_difference();
  const auto of = [&](const Device& device) {
    const auto front = octree_front(device, model, verify::octree_root(model));
    std::vector<std::tuple<int, std::array<std::uint32_t, 3>, CubeColour>> cubes;
    const OctreeSink sink = [&](std::span<const OctreeCube> more) {
      for (const OctreeCube& cube : more) cubes.emplace_back(cube.level, cube.position, cube.colour);
    };
    constexpr int depth = 4;
    for (int level = 0; level < depth; ++level) front->split(level, {}, sink);
    front->deliver_undecided(depth, sink);
    std::ranges::sort(cubes);
    return cubes;
  };
  EXPECT_EQ(of(*device_), of(*small_));
}

/// Candidates share the constant memory, or are read from global memory where it has no room for one.
TEST_F(ModelMemoryTest, CandidatesOfAFitGetTheSameBits) {
  const std::vector<Point> asked = points(3.0);
  const std::vector<double> weights(asked.size(), 0.5);
  std::vector<fit_search::Candidate> candidates(10, {three_primitives().primitives, {0.0, 0.1, 0.2}});
  for (std::size_t n = 0; n < candidates.size(); ++n)
    candidates[n].primitives[0].pose.translation[0] += 0.01 * static_cast<double>(n);
  const auto of = [&](std::size_t constant_memory) {
    Device device = *device_;
    device.constant_memory = constant_memory;
    const auto evaluator = device_candidate_evaluator(device, asked, weights);
    std::vector<fit_search::Evaluation> found;
    evaluator->evaluate(candidates, Fitness{0.2, 0.5, {0.0, 0.4}}, {}, 1, found);
    std::vector<double> numbers;
    for (const fit_search::Evaluation& evaluation : found) {
      numbers.push_back(evaluation.objective);
      numbers.insert(numbers.end(), evaluation.pose_gradient.begin(), evaluation.pose_gradient.end());
      for (const auto& gradient : evaluation.size_gradient)
        numbers.insert(numbers.end(), gradient.begin(), gradient.end());
    }
    std::vector<fit_search::PointDistance> distances;
    evaluator->distances(candidates[1], distances);
    for (const fit_search::PointDistance& distance : distances) numbers.push_back(distance.distance);
    return numbers;
  };
  const std::vector<double> all_at_once = of(device_->constant_memory);
  EXPECT_GT(all_at_once.size(), asked.size());
  EXPECT_EQ(all_at_once, of(2 * (3 * (sizeof(PrimitiveParameters) + sizeof(double))))) << "two candidates at a time";
  EXPECT_EQ(all_at_once, of(0)) << "in global memory";
}

/// A union of a thousand, more than any constant memory of 64 KiB holds: contains what the host proves.
TEST_F(ModelMemoryTest, MapsAThousandPrimitives) {
  small_->constant_memory = std::size_t{64} * 1024;
  Model model;
  for (int i = 0; i < 1000; ++i) {
    const double turn = 0.1 * i;
    model.primitives.push_back({fmt::format("{}", i),
                                {{0.5, 0.4, 0.3}, {0.7, 1.1}},
                                {{10.0 * std::cos(turn), 10.0 * std::sin(turn), 0.02 * i}, {1.0, 0.1, turn, 0.0}}});
  }
  ASSERT_NE(model_memory_option(*small_, model.primitives.size() * sizeof(PrimitiveParameters)), "");
  const std::vector<Point> asked = points(12.0);
  const auto of = [&](const Device& device) {
    return answers<Point>(*point_batch(device, model, 1e-6, false), asked).enclosures;
  };
  const std::vector<Enclosure> found = of(*small_);
  EXPECT_TRUE(same_bits(found, of(*device_)));
  const SignedDistance host(model);
  std::size_t verified_by_device = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (verified(found[i], 1e-6)) ++verified_by_device;
    const Enclosure proven = host(asked[i], 1e-3);
    EXPECT_LE(found[i].lo, proven.hi) << i;
    EXPECT_GE(found[i].hi, proven.lo) << i;
  }
  EXPECT_GT(verified_by_device, queries / 2);
}

}  // namespace
}  // namespace verisq::device
