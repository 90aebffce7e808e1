/// A point of the cavity's surface that is inside, or that may be, ends the search for one.
#include "verify/containment/bone_around_cavity.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "verify/containment/closed_surface.hpp"
#include "verify/containment/rims.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

constexpr double enough_points = 4096.0;

/// Corners, and points between them where triangles are few: a cylinder's may all end beyond the bone.
class PointsOfMesh {
 public:
  explicit PointsOfMesh(const Mesh& mesh)
      : mesh_(mesh),
        step_(1 + static_cast<std::size_t>(static_cast<double>(mesh.triangles.size()) / enough_points)),
        parts_(std::ceil(std::sqrt(2.0 * enough_points / static_cast<double>(mesh.triangles.size())))) {}

  /// No further ones once one is not `beside`.
  template <class Predicate>
  [[nodiscard]] bool all(const Predicate& beside) const {
    for (std::size_t i = 0; i < mesh_.triangles.size(); i += step_) {
      const auto& [a, b, c] = mesh_.triangles[i];
      if (!all_of({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]}, beside)) return false;
    }
    return true;
  }

 private:
  template <class Predicate>
  [[nodiscard]] bool all_of(const Triangle& corners, const Predicate& beside) const {
    for (double i = 0.0; i <= parts_; ++i)
      for (double j = 0.0; i + j <= parts_; ++j)
        if (!beside(mean(corners, {i / parts_, j / parts_}))) return false;
    return true;
  }

  static Point mean(const Triangle& corners, const std::array<double, 2>& weights) {
    Point result{};
    for (std::size_t k = 0; k < 3; ++k)
      result[k] =
          weights[0] * corners[0][k] + weights[1] * corners[1][k] + (1.0 - weights[0] - weights[1]) * corners[2][k];
    return result;
  }

  const Mesh& mesh_;
  std::size_t step_;  ///< from one triangle that is looked at to the next
  double parts_;      ///< of its sides
};

bool is_beside(const Mesh& cavity, const ClosedSurface& outer) {
  return PointsOfMesh(cavity).all([&](const Point& x) { return outer.winding_number(x) == std::optional(0); });
}

}  // namespace

void require_cavities_in_bone(const BoneRegion& bone) {
  for (const BoneSurface& outer : bone.surfaces) {
    if (outer.bone != BoneSide::inside) continue;
    const ClosedSurface closed(closed_triangles(outer.mesh, closing_over_rims(outer.mesh)));
    for (const BoneSurface& cavity : bone.surfaces)
      if (cavity.bone == BoneSide::outside && is_beside(cavity.mesh, closed))
        throw Error(ErrorKind::input,
                    "the cavity lies beside the bone's outer surface: nothing of it is inside. Are both of one bone, "
                    "in the same coordinates?");
  }
}

}  // namespace verisq::verify
