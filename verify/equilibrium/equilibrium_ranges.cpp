/// Joint by joint, cylinder by cylinder.
#include "verify/equilibrium/equilibrium_ranges.hpp"

namespace verisq::verify {

stance::Standing uniform(const stance::Model& model, std::span<const std::size_t> sought, const Enclosure& number) {
  std::vector<Enclosure> positions;
  for (const stance::Body& body : model.bodies) {
    for (const stance::Joint& joint : body.joints) positions.push_back({joint.position, joint.position});
  }
  for (const std::size_t joint : sought) positions[joint] = number;
  positions[height_of_root(model)] = number;
  return {std::move(positions),
          std::vector<Enclosure>(model.degrees_of_freedom(), number),
          std::vector<stance::CylinderLoad>(model.cylinders.size(), {number, number}),
          number,
          number,
          number};
}

}  // namespace verisq::verify
