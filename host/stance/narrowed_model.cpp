/// The parameter, and all quantities that are it.
#include "host/stance/narrowed_model.hpp"

#include <numeric>

namespace verisq::stance {
namespace {

template <class Visit>
void for_each(QuantityVector& vector, const Visit& visit) {
  for (Quantity& quantity : vector) visit(quantity);
}

template <class Visit>
void for_each_quantity(Model& model, const Visit& visit) {
  for_each(model.applied.force, visit);
  visit(model.applied.frequency);
  for (Body& body : model.bodies) {
    for_each(body.offset, visit);
    visit(body.mass);
    for_each(body.centre_of_mass, visit);
    for_each(body.inertia, visit);
  }
  for (ContactCylinder& cylinder : model.cylinders) {
    for_each(cylinder.centre, visit);
    for (Quantity* quantity :
         {&cylinder.radius, &cylinder.stiffness, &cylinder.impact_velocity, &cylinder.normal_restitution,
          &cylinder.tangential_restitution, &cylinder.static_friction, &cylinder.dynamic_friction}) {
      visit(*quantity);
    }
  }
}

}  // namespace

Model narrowed(Model model, std::uint32_t parameter, const Enclosure& range) {
  Parameter& narrow = model.parameters[parameter];
  narrow.range = range;
  if (!range.contains(narrow.nominal)) narrow.nominal = std::midpoint(range.lo, range.hi);
  for_each_quantity(model, [&](Quantity& quantity) {
    if (quantity.parameter == parameter) quantity = {narrow.nominal, narrow.range, parameter};
  });
  return model;
}

}  // namespace verisq::stance
