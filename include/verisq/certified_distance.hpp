/// Distances of two models of any kind, with what proves them again.
#pragma once

#include <functional>
#include <memory>
#include <verisq/model.hpp>
#include <verisq/pair_certificate.hpp>

namespace verisq {

/// By certificates where both models are is_union_of_convex, else by search. Immutable after construction: safe to call
/// from many threads.
class CertifiedDistances {
 public:
  /// `tolerance` is of searches, as SearchOptions has it.
  CertifiedDistances(const Model& a, const Model& b, double tolerance);
  ~CertifiedDistances();
  CertifiedDistances(CertifiedDistances&&) noexcept;
  CertifiedDistances& operator=(CertifiedDistances&&) noexcept;

  /// Encloses the distance of A and of B moved by `pose`, as far as the certificate proves it; once `interrupted` says
  /// so what is proven by then. Throws as ModelSearch.
  [[nodiscard]] CertifiedDistance operator()(const Pose& pose, const std::function<bool()>& interrupted) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
