/// Proves a finished octree again: MPFR, no OpenCL.
#pragma once

#include <memory>
#include <span>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/octree_cube.hpp>

namespace verisq {

/// A closed cube and what is claimed of it: white, no point of it lies in the solid; black, all lie in its interior.
/// Lengths are in half-widths of the root: exact.
struct ColouredCube {
  std::array<double, 3> centre;  ///< from the root's
  double half_width;
  CubeColour colour;
};

/// Immutable after construction: safe to call from many threads.
class OctreeChecker {
 public:
  /// White cubes among `cubes` say nothing new. Throws Error(input) for cubes that overlap or are not the root's.
  OctreeChecker(const Model& model, const OctreeRoot& root, std::span<const OctreeCube> cubes);
  ~OctreeChecker();

  /// What has to be proven for `volume` to contain that of the solid: of the black cubes, and, as white ones, of what
  /// black and gray ones leave of the root, and of all about it that the model may reach.
  [[nodiscard]] const std::vector<ColouredCube>& cubes() const;
  /// That of the black cubes, and of black and gray ones together with 2^-40 of its half-width about the root, rounded
  /// outward.
  [[nodiscard]] Enclosure volume() const;

  /// Whether the claim is proven, by parts of the cube where it takes that.
  [[nodiscard]] bool proves(const ColouredCube& cube) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
