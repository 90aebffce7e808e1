/// What is known of distances without any search: for the queries that a time limit leaves.
#pragma once

#include <optional>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// An enclosure of the signed distance of one point.
struct KnownDistance {
  Point at;
  Enclosure distance;
};

/// Enclosures by the model's bounding box, and by distances that are known elsewhere: signed distances change by no
/// more than the way between two points. Immutable: safe to call from many threads.
class CoarseDistance {
 public:
  CoarseDistance(const Model& model, std::vector<KnownDistance> known);

  /// Of the exact signed distance; an end is infinite where nothing tells it.
  [[nodiscard]] Enclosure operator()(const Point& x) const;

 private:
  Box box_;
  std::vector<KnownDistance> known_;
};

/// The same with certificates: from below by bounding spheres or an escape from the bounding box, from above by the
/// point of a primitive on the way to its centre. Immutable: safe to call from many threads.
class CoarseProof {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit CoarseProof(const Model& model);

  [[nodiscard]] CertifiedEnclosure operator()(const Point& x) const;

  /// Of the distance of a triangle, 0 where it meets the model.
  [[nodiscard]] CertifiedEnclosure operator()(const Triangle& triangle) const;

 private:
  [[nodiscard]] Normal towards_nearest_centre(const Point& x) const;

  ExactChecker checker_;
  Box box_;
  std::vector<Point> centres_;  ///< of the primitives
};

}  // namespace verisq::verify
