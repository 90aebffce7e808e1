/// The boxes of the bound, each proven by the checker itself.
#include "verisq/certified_best_fit.hpp"

#include <utility>
#include <vector>

#include "host/fit/candidate_space.hpp"
#include "host/mesh/eigen_points.hpp"

namespace verisq {

namespace {

/// How much further than the search's a box is halved: intervals are hardly wider, contained balls a little smaller.
constexpr std::size_t further_levels = 12;
/// Than the bound, and than what is proven, so that other roundings than the checker's prove it, too.
constexpr double slightly_more = 1.0 + 1e-9;

}  // namespace

std::optional<CertifiedBestFit> certified_best_fit(std::span<const UncertainModel> series, const Cavity& cavity,
                                                   const BestFitTerms& terms, const FitBound& bound,
                                                   const CheckOptions& check) {
  CertifiedBestFit result{.claim = {.terms = {terms.fitness, terms.penetration_limit, cavity.areas, cavity.area_of},
                                    .range = terms.range,
                                    .centres = {},
                                    .upper = bound.upper},
                          .certificate = {}};
  std::vector<Model> models;
  for (const UncertainModel& implant : series) {
    models.push_back(bracket(implant).largest);
    result.claim.centres.push_back(point_of(fit_search::CandidateSpace(implant, terms.range).pose_space().centre));
  }
  const BestFitChecker checker(models, cavity.points, result.claim);
  const double enough = bound.upper * slightly_more;  // or minus infinity: F above the limit is positive
  RefinedBestFit refined = checker.refined({bound.divisions}, enough, further_levels, check);
  if (check.interrupted()) return std::nullopt;
  result.certificate = std::move(refined.certificate);
  result.claim.upper = refined.upper * slightly_more;  // what is proven, whatever the search found
  return result;
}

}  // namespace verisq
