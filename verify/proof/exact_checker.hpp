/// Proves distances to an ordinary model by certificates.
#pragma once

#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verisq/checker.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The model's set operations; without any, the union of all primitives.
[[nodiscard]] SetExpression set_of(const Model& model);

/// Precondition: not a mesh.
[[nodiscard]] PosedPrimitive posed(const Primitive& primitive);

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  /// Throws Error(input) for a model that is not valid, or has a mesh.
  explicit ExactChecker(const Model& model);

  /// The enclosure of the exact signed distance that the certificate proves, whatever the certificate contains. An
  /// inner end, and an end proven by a cover, is proven no farther than claimed. `interrupted`, unless empty, is
  /// polled; once it returns true, the enclosure is looser. Preconditions: those of Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// The same for the distance of a triangle.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// The set and the primitives that covers are about.
  [[nodiscard]] const SetExpression& set() const { return set_; }
  [[nodiscard]] std::span<const PosedPrimitive> primitives() const { return primitives_; }

 private:
  template <class Query>
  [[nodiscard]] bool is_covered(const Query& query, double radius, Place wanted, const Certificate& certificate,
                                const Hook& interrupted) const;
  [[nodiscard]] double distance_of(const PreciseVector& x, const std::optional<Point>& p, Place place) const;
  [[nodiscard]] double proven_lower(const Point& x, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_upper(const Point& x, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_lower(const Triangle& triangle, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_upper(const Triangle& triangle, double claimed, const Certificate& certificate) const;

  std::vector<PosedPrimitive> primitives_;
  SetExpression set_;
  bool is_union_ = false;
};

}  // namespace verisq::verify
