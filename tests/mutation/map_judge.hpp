/// Judges kernels by the maps that they make: `check` must prove of them what it proves of the true kernels' maps.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

/// Points of one model, to be mapped at one tolerance.
struct Scene {
  std::string name;
  Model model;
  double tolerance;
  std::vector<Point> points;
};

/// What is wrong with a map.
struct Judgement {
  std::size_t false_rows = 0;     ///< enclosures proven to miss the exact signed distance
  std::size_t unproved_rows = 0;  ///< not proved by `check`, those included, as far as counted
  std::string first;              ///< one line on the first of them; empty when all is well
};

class MapJudge {
 public:
  /// Finds the truth, in about a millisecond a point.
  explicit MapJudge(std::vector<Scene> scenes);

  /// The map that the true kernels make, a scene after the other, and whether `check` proves its rows: only those
  /// count.
  struct AcceptedRow {
    CertifiedEnclosure row;
    bool proved;
  };
  using AcceptedMap = std::vector<AcceptedRow>;
  [[nodiscard]] std::vector<AcceptedMap> accepted(const CompiledKernels& true_kernels) const;

  /// Of the map that `kernels` make. False rows are counted; if there are none, the others are checked up to the first
  /// that is not proved.
  [[nodiscard]] Judgement operator()(const CompiledKernels& kernels, std::span<const AcceptedMap> accepted) const;

 private:
  struct KnownScene {
    Scene scene;
    Checker check;
    std::vector<Enclosure> truth;  ///< by the host, as tight as it can
  };

  std::vector<KnownScene> scenes_;
};

}  // namespace verisq::mutation
