/// Forward kinematics in interval arithmetic.
#include "host/stance/side_view.hpp"

#include "verify/stance/kinematics.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

SidePoint side_point(const Vector3<Interval>& point) {
  return {{point[0].lower(), point[0].upper()}, {point[1].lower(), point[1].upper()}};
}

}  // namespace

SideView side_view(const Model& model, UncertainSet uncertain, std::span<const Enclosure> positions) {
  const std::vector<Interval> parameters = parameter_box(model, uncertain);
  const auto in_body = [&](const QuantityVector& point) {
    return values_of(point, std::span<const Interval>(parameters));
  };
  std::vector<Interval> joints;
  for (const Enclosure& position : positions) joints.emplace_back(position.lo, position.hi);
  const Tree<Interval> tree = tree_of(model, std::span<const Interval>(parameters), joints);
  const std::vector<BodyPose<Interval>> poses = forward_kinematics(tree);
  SideView view;
  for (const BodyPose<Interval>& pose : poses) view.origins.push_back(side_point(pose.position));
  for (const ContactCylinder& cylinder : model.cylinders)
    view.cylinders.push_back(side_point(poses[cylinder.body].point(in_body(cylinder.centre))));
  view.trunk = side_point(poses.front().point(in_body(model.bodies.front().centre_of_mass)));
  return view;
}

std::vector<Enclosure> all_positions(const SagittalModel& sagittal, std::span<const Enclosure> positions) {
  std::vector<Enclosure> all;
  for (const Body& body : sagittal.model.bodies) {
    for (const Joint& joint : body.joints) all.push_back({joint.position, joint.position});
  }
  for (std::size_t k = 0; k < positions.size(); ++k) {
    for (const std::size_t joint : sagittal.joints[k].joints) all[joint] = positions[k];
  }
  return all;
}

}  // namespace verisq::stance
