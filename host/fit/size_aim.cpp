/// The volumes of the primitives as a term of the objective.
#include "host/fit/size_aim.hpp"

#include "host/fit/implant_size.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {
namespace {

constexpr double weights_of_all_points = 100.0;

}  // namespace

SizeAim::SizeAim(const CandidateSpace& space, double weight) : least_size_(implant_size(space.sized(space.lower()))) {
  const double range = implant_size(space.sized(space.upper())) - least_size_;
  if (!(range > 0.0)) return;  // nothing to choose
  most_ = weights_of_all_points * weight;
  per_size_ = most_ / range;
}

double SizeAim::value(std::span<const Primitive> primitives) const {
  if (most_ == 0.0) return 0.0;
  double size = 0.0;
  for (const Primitive& primitive : primitives) size += volume(primitive.superquadric);
  return per_size_ * (size - least_size_);
}

void SizeAim::add_to(Evaluation& evaluation, const Candidate& candidate) const {
  if (most_ == 0.0) return;
  evaluation.objective += value(candidate.primitives);
  for (std::size_t k = 0; k < candidate.primitives.size(); ++k) {
    const Superquadric& solid = candidate.primitives[k].superquadric;
    const double of_primitive = per_size_ * volume(solid);
    for (std::size_t axis = 0; axis < 3; ++axis)
      evaluation.size_gradient[k][axis] += of_primitive / solid.semi_axes[axis];
  }
}

}  // namespace verisq::fit_search
