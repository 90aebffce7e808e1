/// Reproducible random solids, poses and query points, with extra mass where proofs are hard.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::oracle {

/// How a query point is placed relative to the solid; lengths in units of the largest semi-axis.
enum class PointFamily : std::uint8_t {
  along_normal,   ///< 1e-9 to 1e6 outside along the normal of a boundary point
  any_direction,  ///< gauge 1 + 1e-9 to 1 + 1e6 on a ray from the centre
  deep_inside,    ///< gauge 0 to 1 on a ray from the centre
  just_inside,    ///< 1e-9 to 1e-1 inside along the normal of a boundary point
  on_boundary,    ///< a boundary point rounded to binary64: either side
  on_plane,       ///< one coordinate of the solid's own frame zero, inside or outside
  on_axis,        ///< two coordinates zero, inside or outside
  centre,
};

inline constexpr std::array point_families{
    PointFamily::along_normal, PointFamily::any_direction, PointFamily::deep_inside, PointFamily::just_inside,
    PointFamily::on_boundary,  PointFamily::on_plane,      PointFamily::on_axis,     PointFamily::centre};

[[nodiscard]] std::string_view to_string(PointFamily family);

struct RandomPoint {
  Point point;
  PointFamily family;
};

/// A boundary point in the solid's own frame and the outward unit normal there, up to rounding.
struct BoundaryPoint {
  Point point;
  Point normal;
};

/// The standard fixes the engine; the distributions are written out here, because it does not fix those.
class RandomCases {
 public:
  explicit RandomCases(std::uint64_t seed) : engine_(seed) {}

  /// Exponents in [0.05, 2]: uniform, and near or at 0.05, 1 and 2; some below, where a proof may be wide. Semi-axes:
  /// ratios to 400 around a scale of 1e-3 to 1e3, at times equal. Pose: identity, a quarter turn (exact in binary64),
  /// or anything.
  [[nodiscard]] Primitive solid();

  /// `superquadric`, or a random one where there is none, in a random pose.
  [[nodiscard]] Primitive solid(const std::optional<Superquadric>& superquadric);

  /// Zero coordinates in the solid's own frame survive the pose exactly where it is the identity or a quarter turn.
  [[nodiscard]] RandomPoint point(const Primitive& solid);

  /// Half of the rays from the centre uniform on the sphere, half on the ellipsoid of the same semi-axes.
  [[nodiscard]] BoundaryPoint boundary_point(const Superquadric& superquadric);

  [[nodiscard]] double uniform(double low, double high);
  /// Logarithm uniform; precondition 0 < low < high.
  [[nodiscard]] double log_uniform(double low, double high);
  [[nodiscard]] std::size_t choice(std::size_t count);
  /// Uniform on the unit sphere.
  [[nodiscard]] Point direction();

 private:
  [[nodiscard]] double exponent();
  [[nodiscard]] Pose pose(double size);
  [[nodiscard]] Point local_point(const Superquadric& superquadric, PointFamily family);

  std::mt19937_64 engine_;
};

}  // namespace verisq::oracle
