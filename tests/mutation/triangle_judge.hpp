/// Judges the triangle kernels by their enclosures, against the references at 200 bits, and by their certificates.
#pragma once

#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"
#include "tests/oracle/triangle_reference.hpp"

namespace verisq::mutation {

/// Triangles around one model whose largest semi-axis is in [1, 2): its frame is the device's.
struct TriangleScene {
  std::string name;
  Model model;
  std::vector<Triangle> triangles;
};

/// Single solids and unions; triangles far away, nearly touching, passed over by a sphere, and at the limits of
/// binary64. The same at every call.
[[nodiscard]] std::vector<TriangleScene> triangle_scenes();

class TriangleJudge {
 public:
  /// Finds the references, in some milliseconds a triangle.
  explicit TriangleJudge(std::vector<TriangleScene> scenes);

  /// The first enclosure, of a primitive or of the union, that misses the distance, or the first weights beside an
  /// upper end that are no point's of the triangle; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

  /// The first row that `check` does not prove of a map by `kernels`, though it proves that of `true_kernels`.
  [[nodiscard]] std::string unproved_row(const CompiledKernels& kernels, const CompiledKernels& true_kernels) const;

 private:
  struct KnownScene {
    TriangleScene scene;
    Checker check;
    std::vector<std::vector<oracle::TriangleReference>> references;  ///< of each triangle and primitive
  };

  std::vector<KnownScene> scenes_;
};

}  // namespace verisq::mutation
