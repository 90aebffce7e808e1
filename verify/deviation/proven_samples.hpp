/// What certificates of signed distances at points prove of a model, whatever they claim (docs/mathematics.md §20).
#pragma once

#include <atomic>
#include <cstdint>

#include "verify/deviation/proven_triangle.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verisq/certificate.hpp"
#include "verisq/checker.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Immutable after construction: safe to call from many threads.
class ProvenSamples {
 public:
  explicit ProvenSamples(const Model& model);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return convex_; }

  /// What is claimed where its certificate proves that; else what is proven instead, and `proved` is false.
  [[nodiscard]] Enclosure distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved) const;

  /// As `SampleProofs`.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, const Certificate& certificate) const;

  /// Whether the model is the union of its primitives.
  [[nodiscard]] bool is_union() const { return is_union_; }

  /// Whether nothing of the surface of any primitive but this one is proven to be within `reach` of the point, by
  /// spheres and the normals of the certificate: all others are farther or, where the model is not their union, hold
  /// all of that ball.
  [[nodiscard]] bool are_others_away(const Point& x, double reach, std::size_t primitive,
                                     const Certificate& certificate) const;

 private:
  Model model_;
  Checker checker_;
  ExactChecker primitives_;
  bool is_union_;
  bool convex_;
};

/// The samples of one certificate as they are looked at, by many threads. `samples` must outlive it.
class SampleTally {
 public:
  explicit SampleTally(const ProvenSamples& samples) : samples_(samples) {}

  [[nodiscard]] Enclosure operator()(const Point& x, const CertifiedEnclosure& claimed);

  /// Refers to this.
  [[nodiscard]] SampleProofs proofs();

  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }
  /// Of these: they say less than they claim.
  [[nodiscard]] std::uint64_t unproved() const { return unproved_; }

 private:
  const ProvenSamples& samples_;
  std::atomic<std::uint64_t> looked_at_{0};
  std::atomic<std::uint64_t> unproved_{0};
};

}  // namespace verisq::verify
