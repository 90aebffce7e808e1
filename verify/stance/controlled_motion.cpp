/// The box of parameters about its middle, and the order of the state.
#include "verify/stance/controlled_motion.hpp"

#include <algorithm>

namespace verisq::stance {
namespace motion_details {

AffineDamping::AffineDamping(const Interval& restitution)
    : middle(0.5 * restitution.lower() + 0.5 * restitution.upper()),
      at_middle(damping_factor(Interval(middle))),
      slope(damping_slope(Interval(middle), at_middle)),
      rest(0) {
  if (restitution.lower() == restitution.upper()) return;
  const Interval change = restitution - Interval(middle);
  rest = (damping_slope(restitution, damping_factor(restitution)) - slope) * change;
}

}  // namespace motion_details

ControlledMotion::ControlledMotion(const SagittalModel& model, std::vector<Interval> box, std::optional<Push> push)
    : model_(model), push_(push) {
  for (std::uint32_t i = 0; i < box.size(); ++i) {
    const double centre = 0.5 * box[i].lower() + 0.5 * box[i].upper();
    centre_.push_back(centre);
    if (box[i].lower() == box[i].upper()) continue;
    uncertain_.push_back(i);
    radius_.push_back(std::max((Interval(centre) - Interval(box[i].lower())).upper(),
                               (Interval(box[i].upper()) - Interval(centre)).upper()));
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    if (model.joints[j].integral != 0.0) integrals_.push_back(j);
  }
  for (const SagittalContact& contact : model.contacts) {
    const Quantity& restitution = model.model.cylinders[contact.cylinder].normal_restitution;
    damping_.emplace_back(value_of<Interval>(restitution, box));
  }
}

Eigen::MatrixXd ControlledMotion::tether() const {
  constexpr double frequency = 10.0;  // 1/s
  constexpr std::size_t of_root = 3;
  const auto n = static_cast<Eigen::Index>(size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t j = 0; j < of_root; ++j) {
    const double distinct = frequency * (1.0 + 0.1 * static_cast<double>(j));  // equal ones would nearly coincide again
    const auto velocity = static_cast<Eigen::Index>(j);
    result(velocity, static_cast<Eigen::Index>(position(j))) = -distinct * distinct;
    result(velocity, velocity) = -distinct;
  }
  return result;
}

std::vector<double> ControlledMotion::breaks() const {
  if (!push_) return {};
  return {push_->start, push_->start + push_->duration};
}

}  // namespace verisq::stance
