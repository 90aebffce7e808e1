/// One of two searches.
#include "verisq/certified_distance.hpp"

#include <optional>
#include <utility>

#include "verisq/model_distance.hpp"
#include "verisq/model_search.hpp"

namespace verisq {

struct CertifiedDistances::State {
  State(const Model& a, const Model& b, double width) : tolerance(width) {
    if (is_union_of_convex(a) && is_union_of_convex(b)) {
      convex.emplace(a, b);
    } else {
      search.emplace(a, b);
    }
  }

  [[nodiscard]] CertifiedDistance distance(const Pose& pose, const std::function<bool()>& interrupted) const {
    if (convex) {
      ModelDistance found = (*convex)(pose, interrupted);
      return {found.distance, std::move(found.certificate)};
    }
    const SearchOptions options{.tolerance = tolerance, .interrupted = interrupted};
    return search->certified(pose, (*search)(pose, options), options);
  }

  double tolerance;
  std::optional<PairDistance> convex;
  std::optional<ModelSearch> search;
};

CertifiedDistances::CertifiedDistances(const Model& a, const Model& b, double tolerance)
    : state_(std::make_unique<State>(a, b, tolerance)) {}
CertifiedDistances::~CertifiedDistances() = default;
CertifiedDistances::CertifiedDistances(CertifiedDistances&&) noexcept = default;
CertifiedDistances& CertifiedDistances::operator=(CertifiedDistances&&) noexcept = default;

CertifiedDistance CertifiedDistances::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  return state_->distance(pose, interrupted);
}

}  // namespace verisq
