/// What certificates prove of the distances to an ordinary model.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/triangle_certificate.hpp"
#include "verisq/certificate.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit ExactChecker(const Model& model);

  /// An enclosure of the exact signed distance, whatever the certificate holds; no farther in than `claimed`, where
  /// work can be spared so. Preconditions as for Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed,
                                     const Certificate& certificate) const;

  /// The same of the distance of a triangle.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed,
                                     const Certificate& certificate) const;

 private:
  [[nodiscard]] double lower_by_normals(const Point& x, std::span<const Normal> normals) const;
  [[nodiscard]] double lower_by_escape(const Point& x, const Point& escape) const;
  [[nodiscard]] double lower(const Point& x, const Certificate& certificate) const;
  [[nodiscard]] double upper(const Point& x, double claimed, std::span<const Normal> normals) const;
  [[nodiscard]] double lower(const Triangle& triangle, std::span<const Normal> normals) const;
  [[nodiscard]] double upper(const Triangle& triangle, double claimed, const std::optional<Weights>& weights,
                             std::span<const Normal> normals) const;
  [[nodiscard]] std::vector<Normal> known(std::vector<Normal> normals) const;

  std::vector<PosedSuperquadric> primitives_;
};

}  // namespace verisq::verify
