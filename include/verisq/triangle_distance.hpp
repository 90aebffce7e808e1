/// The host's own proof of the distance of a triangle to a model: Boost.Interval and MPFR, no OpenCL.
#pragma once

#include <memory>
#include <verisq/certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Distance of a triangle, its interior included, to a model: 0 where they meet (docs/mathematics.md §6). Immutable
/// after construction: safe to call from many threads.
class TriangleDistance {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit TriangleDistance(const Model& model);
  ~TriangleDistance();
  TriangleDistance(TriangleDistance&&) noexcept;
  TriangleDistance& operator=(TriangleDistance&&) noexcept;

  /// Encloses the exact distance as tightly as the method gives. The triangle may be degenerate. Never throws for
  /// finite corners; the enclosure is always valid, and [0, 0] where the triangle is proven to meet the model.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle) const;

  /// The same with what proves it: the enclosure is what `Checker` proves from the certificate.
  [[nodiscard]] CertifiedEnclosure certified(const Triangle& triangle) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
