/// What certificates prove of the distances to an ordinary model.
#pragma once

#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verisq/checker.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  explicit ExactChecker(const Model& model);

  /// What the certificate proves, whatever it holds: an enclosure of the exact signed distance; an inner end, and what
  /// a cover proves, no farther than claimed. Once `interrupted`, polled unless empty, says so, less. Preconditions as
  /// for Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// The same of the distance of a triangle.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// What covers are of.
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
