/// Reproducible random models, bent and combined, and query points where proofs about them are hard.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/solid_reference.hpp"

namespace verisq::oracle {

enum class ModelFamily : std::uint8_t {
  bent,             ///< one bent superquadric
  plain_csg,        ///< a random tree over two to five overlapping superquadrics
  bent_csg,         ///< the same, most of them bent
  thin_difference,  ///< a shell of 1e-4 to 1e-1 of the semi-axes, at times cut open
  nearly_touching,  ///< two that are 1e-9 to 1e-3 apart, or overlap by that, united
  tiny_curvature,   ///< as bent or bent_csg with curvatures of 1e-5, 1e-9 and 1e-300 a size
  tapered,          ///< as bent or bent_csg, most of them tapered, too, by ratios of the ends up to 19
};

inline constexpr std::array model_families{ModelFamily::bent,
                                           ModelFamily::plain_csg,
                                           ModelFamily::bent_csg,
                                           ModelFamily::thin_difference,
                                           ModelFamily::nearly_touching,
                                           ModelFamily::tiny_curvature,
                                           ModelFamily::tapered};

[[nodiscard]] std::string_view to_string(ModelFamily family);

/// Lengths in units of the size.
enum class SolidPointFamily : std::uint8_t {
  far,           ///< 2 to 1e3 from the model
  around,        ///< within the bounding ball
  near_surface,  ///< 1e-9 to 1e-1 off the boundary of a primitive, either side
  on_surface,    ///< a boundary point of a primitive, rounded to binary64
  near_rim,      ///< 1e-9 to 1e-1 off a curve where two primitives' boundaries meet
  on_axis,       ///< on an axis or plane of a primitive's own frame, carried along by the bend
  bend_centre,   ///< at the centre of curvature, near it or behind it, where the inverse of the bend is cut
};

inline constexpr std::array solid_point_families{
    SolidPointFamily::far,      SolidPointFamily::around,  SolidPointFamily::near_surface, SolidPointFamily::on_surface,
    SolidPointFamily::near_rim, SolidPointFamily::on_axis, SolidPointFamily::bend_centre};

[[nodiscard]] std::string_view to_string(SolidPointFamily family);

class RandomSolids {
 public:
  explicit RandomSolids(std::uint64_t seed) : random_(seed) {}

  /// Semi-axes within a factor of 10 around a scale of 1e-2 to 1e2, exponents in [0.05, 2]; bends within |k| h < 0.9
  /// and |k| a3 < 3, where h is the largest |r|.
  [[nodiscard]] Model model(ModelFamily family);

  /// Two models of comparable size, neither empty as far as sampling tells: overlapping, or up to some sizes apart.
  [[nodiscard]] std::array<Model, 2> pair();

  /// The next point; where the family does not exist (no rim found, no bend) one of another family.
  [[nodiscard]] Point point(const PlacedModel& model, SolidPointFamily family);

 private:
  [[nodiscard]] double exponent();
  [[nodiscard]] Superquadric superquadric(double scale);
  [[nodiscard]] std::array<double, 4> quaternion();
  [[nodiscard]] Bend bend(const Superquadric& superquadric);
  [[nodiscard]] Primitive primitive(double scale, double reach, bool bent);
  void taper(Primitive& primitive);
  [[nodiscard]] Model overlapping(double share_of_bent);
  [[nodiscard]] Model shell();
  [[nodiscard]] Model pair_with_gap();
  [[nodiscard]] SetExpression tree(std::vector<std::uint32_t> leaves, int depth);
  [[nodiscard]] const PlacedPrimitive& any_of(const PlacedModel& model);
  [[nodiscard]] Point moved(const Point& x, double distance);
  [[nodiscard]] Point surface_point(const PlacedPrimitive& p);
  [[nodiscard]] Point rim_point(const PlacedModel& model);
  [[nodiscard]] Point axis_point(const PlacedPrimitive& p);
  [[nodiscard]] Point behind_bend(const PlacedModel& model);

  RandomCases random_;
};

}  // namespace verisq::oracle
