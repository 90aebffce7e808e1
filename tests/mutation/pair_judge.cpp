/// This file implements the launches of the kernel of pairs and the comparison.
#include "tests/mutation/pair_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/in_parallel.hpp"

namespace verisq::mutation {
namespace {

using oracle::PosedSolid;
using oracle::Real;

Columns pose_columns(const std::vector<Pose>& poses, std::size_t length) {
  Columns columns(12);
  for (std::size_t n = 0; n < length; ++n) {
    const Pose& pose = poses[std::min(n, poses.size() - 1)];
    const auto rotation = device::rotation_matrix(pose.quaternion);
    for (std::size_t i = 0; i < rotation.size(); ++i) columns[i].push_back(rotation[i]);
    for (std::size_t i = 0; i < 3; ++i) columns[rotation.size() + i].push_back(pose.translation[i]);
  }
  return columns;
}

/// Launched as host/device/query_batches.cpp does.
std::vector<Enclosure> mapped(const CompiledKernels& kernels, const PairScene& scene) {
  const Model both = device::joined(scene.a, scene.b);
  const std::size_t length = padded(scene.poses.size(), kernels);
  const cl::NDRange groups(length / static_cast<std::size_t>(kernels.vector_width));
  const cl::CommandQueue queue(kernels.context, kernels.device);
  // A kernel does not keep the buffers that it is given.
  const cl::Buffer poses = uploaded(kernels, pose_columns(scene.poses, length));
  const cl::Buffer primitives = uploaded(kernels, both.primitives);
  const std::array ends{zeros(kernels, length), zeros(kernels, length)};
  cl::Kernel kernel(kernels.program, "pair_distance");
  kernel.setArg(0, cl_ulong{groups[0]});
  kernel.setArg(1, cl_ulong{length});
  kernel.setArg(2, poses);
  kernel.setArg(3, primitives);
  kernel.setArg(7, ends[0]);
  kernel.setArg(8, ends[1]);
  const auto first_of_b = static_cast<cl_uint>(scene.a.primitives.size());
  for (cl_uint a = 0; a < first_of_b; ++a) {
    for (cl_uint b = first_of_b; b < both.primitives.size(); ++b) {
      kernel.setArg(4, a);
      kernel.setArg(5, b);
      kernel.setArg(6, cl_uint{a == 0 && b == first_of_b ? 1U : 0U});
      queue.enqueueNDRangeKernel(kernel, cl::NullRange, groups);
    }
  }
  const std::vector<double> los = read(queue, ends[0], length);
  const std::vector<double> his = read(queue, ends[1], length);
  std::vector<Enclosure> enclosures;
  for (std::size_t n = 0; n < scene.poses.size(); ++n) enclosures.push_back({los[n], his[n]});
  return enclosures;
}

}  // namespace

PairJudge::PairJudge(std::vector<PairScene> scenes) {
  for (PairScene& scene : scenes) {
    std::vector<Bounds> references(scene.poses.size());
    oracle::in_parallel(references.size(), [&](std::size_t n) {
      bool first = true;
      for (const Primitive& a : scene.a.primitives) {
        for (const Primitive& b : scene.b.primitives) {
          const auto pair = oracle::reference_distance(PosedSolid(a.superquadric, a.pose),
                                                       PosedSolid(b.superquadric, b.pose).moved(scene.poses[n]));
          auto& [lower, upper] = references[n];
          lower = first ? pair.lower : std::min(lower, pair.lower);
          upper = first ? pair.upper : std::min(upper, pair.upper);
          first = false;
        }
      }
    });
    scenes_.push_back({std::move(scene), std::move(references)});
  }
}

std::string PairJudge::false_claim(const CompiledKernels& kernels) const {
  for (const auto& [scene, references] : scenes_) {
    const std::vector<Enclosure> enclosures = mapped(kernels, scene);
    for (std::size_t n = 0; n < enclosures.size(); ++n) {
      const auto& [lo, hi] = enclosures[n];
      const auto& [lower, upper] = references[n];
      if (lo <= upper && hi >= lower) continue;  // NaN is false
      return fmt::format("{}, pose {}: [{:.17g}, {:.17g}], the truth is in [{}, {}]", scene.name, n, lo, hi,
                         oracle::text(lower), oracle::text(upper));
    }
  }
  return {};
}

}  // namespace verisq::mutation
