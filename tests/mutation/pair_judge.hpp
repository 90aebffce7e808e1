/// Judges the kernel of pairs by its enclosures, against the references at 200 bits.
#pragma once

#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"
#include "tests/oracle/pair_reference.hpp"

namespace verisq::mutation {

/// Poses of model B beside model A. The largest semi-axis of both is in [1, 2): their frame is the device's.
struct PairScene {
  std::string name;
  Model a, b;
  std::vector<Pose> poses;
};

/// Separated, nearly touching, overlapping and far apart; models of several primitives, of which all but the nearest
/// are passed over. The same at every call.
[[nodiscard]] std::vector<PairScene> pair_scenes();

class PairJudge {
 public:
  /// Finds the references, in some milliseconds a pose.
  explicit PairJudge(std::vector<PairScene> scenes);

  /// The first enclosure that misses the distance; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

 private:
  struct Bounds {
    oracle::Real lower, upper;  ///< of the exact distance
  };
  struct KnownScene {
    PairScene scene;
    std::vector<Bounds> references;  ///< of each pose
  };

  std::vector<KnownScene> scenes_;
};

}  // namespace verisq::mutation
