/// The distance of a triangle to any model, bent or built by set operations, by branch and bound over parts of the
/// triangle. For unions of convex primitives triangle_distance.hpp is faster.
#pragma once

#include <functional>
#include <memory>
#include <verisq/certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Distance of a triangle, its interior included, to a model: 0 where they meet (docs/mathematics.md §6), from signed
/// distances of points (SignedDistance). Immutable after construction: safe to call from many threads.
class TriangleSearch {
 public:
  explicit TriangleSearch(const Model& model);
  ~TriangleSearch();
  TriangleSearch(TriangleSearch&&) noexcept;
  TriangleSearch& operator=(TriangleSearch&&) noexcept;

  /// Encloses the exact distance; works until it is at most `tolerance` wide, in model units, until `interrupted`,
  /// polled by the calling thread, says so, or until its budget of points is spent: then it is valid, and wide. The
  /// triangle may be degenerate. Never throws for finite corners; [0, 0] where the triangle is proven to meet the
  /// model. Of an empty solid the upper end is infinite.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, double tolerance,
                                     const std::function<bool()>& interrupted = {}) const;

  /// The same with what proves it: the enclosure is what `Checker` proves from the certificate, by a witness and a
  /// cover (docs/mathematics.md §28). Some milliseconds to some tenths of a second a triangle; wide where a cover would
  /// have too many cells.
  [[nodiscard]] CertifiedEnclosure certified(const Triangle& triangle, double tolerance,
                                             const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
