/// Judges the bounds of models with set operations that need no search: against points that are known to lie in the
/// sets of an edge, and the enclosures that come out against the host's.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

inline constexpr std::size_t set_primitives = 4;

/// What two primitives have in common, united with the difference of two others: one structure, so that all scenes
/// share a program. None is bent. The largest semi-axis is in [1, 2): the frame of the device is the model's.
struct SetScene {
  std::string name;
  Model model;
};

/// The same at every call.
[[nodiscard]] std::vector<SetScene> set_scenes();

class SetJudge {
 public:
  /// Has the host find all distances that are known before kernels run.
  explicit SetJudge(std::vector<SetScene> scenes);

  /// The true kernels of the scenes' structure.
  [[nodiscard]] static std::string sources();

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

  /// What set_bounds is given for a query, and a point of both literals: no bound may exceed its distance.
  struct EdgeRow {
    Point query;
    Point witness;
    double edge;
    double others;
    Point foot;
    std::array<Point, set_primitives> centres;
    std::array<double, set_primitives> ball_his;
    bool complement;
  };

  /// What set_feet is given for a query, and what is known of it.
  struct Query {
    Point point;
    std::array<Enclosure, set_primitives> of_primitives;
    std::array<Point, set_primitives> normals;
    Enclosure distance;  ///< of the model, by the host
  };

 private:
  struct KnownScene {
    SetScene scene;
    std::vector<EdgeRow> rows;
    std::vector<Query> queries;
  };

  std::vector<KnownScene> scenes_;
};

}  // namespace verisq::mutation
