/// Judges the kernels of bent and combined solids: what they claim about cubes, against points whose place is known,
/// and the enclosures of their searches, against the host's.
#pragma once

#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

/// One bent primitive minus one that is not: one structure, so that all scenes share a program. The largest semi-axis
/// is in [1, 2): the frame of the device is the model's.
struct SolidScene {
  std::string name;
  Model model;
  std::vector<Point> points;     ///< queries of the search
  bool loose_constants = false;  ///< the kernels are told of a taper that is off, and how far
};

/// The same at every call; of the latter all primitives are tapered.
[[nodiscard]] std::vector<SolidScene> solid_scenes();
[[nodiscard]] std::vector<SolidScene> tapered_solid_scenes();

class SolidJudge {
 public:
  /// Has the host find the distances of all queries.
  explicit SolidJudge(std::vector<SolidScene> scenes);

  /// The true kernels of the scenes' structure, with one that shows what is claimed about cubes.
  [[nodiscard]] std::string sources() const;

  /// A first claim that is false; empty when all is well. `with_searches`: of the enclosures, too.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels, bool with_searches) const;

  /// A cube with a point of it, and another point that asks for its distance.
  struct Witness {
    Point centre;
    double half_width;
    Point point;
    Point query;
    double bent_upper;  ///< of the query's distance to the bent primitive
  };

 private:
  struct KnownScene {
    SolidScene scene;
    std::vector<Witness> witnesses;
    std::vector<Enclosure> distances;                   ///< of the model, by the host
    std::vector<std::vector<Enclosure>> of_primitives;  ///< of each primitive on its own
  };

  std::vector<KnownScene> scenes_;
};

}  // namespace verisq::mutation
