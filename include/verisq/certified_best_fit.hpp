/// How good a fit can be at best, with what proves it again.
#pragma once

#include <optional>
#include <span>
#include <verisq/best_fit_certificate.hpp>
#include <verisq/cavity.hpp>
#include <verisq/check_options.hpp>
#include <verisq/fit_bound.hpp>
#include <verisq/fitness.hpp>
#include <verisq/pose_range.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

struct CertifiedBestFit {
  BestFitClaim claim;  ///< `upper`: what the certificate proves, about that of the bound
  BestFitCertificate certificate;
};

/// What a bound is of.
struct BestFitTerms {
  Fitness fitness;
  double penetration_limit;
  PoseRange range;
};

/// Of a bound that `bound_fit` found of the same series, cavity and terms: its boxes, halved further where their
/// bound in intervals is larger. Nothing where `interrupted` ended it. Throws Error(input) as `bound_fit`.
[[nodiscard]] std::optional<CertifiedBestFit> certified_best_fit(std::span<const UncertainModel> series,
                                                                 const Cavity& cavity, const BestFitTerms& terms,
                                                                 const FitBound& bound, const CheckOptions& check);

}  // namespace verisq
