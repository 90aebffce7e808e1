/// The parameter, and all quantities that are it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/stance_choice.hpp>

#include "verify/numbers/rounding.hpp"

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
  // What the reader asks of the ends of a range holds of its parts.
  if (!(range.lo <= range.hi) || !narrow.range.contains(range.lo) || !narrow.range.contains(range.hi)) {
    throw Error(ErrorKind::input, fmt::format("--range: {}={},{} is not within the file's range [{}, {}]", narrow.name,
                                              range.lo, range.hi, narrow.range.lo, narrow.range.hi));
  }
  narrow.range = range;
  if (!range.contains(narrow.nominal)) narrow.nominal = std::midpoint(range.lo, range.hi);
  for_each_quantity(model, [&](Quantity& quantity) {
    if (quantity.parameter == parameter) quantity = {narrow.nominal, narrow.range, parameter};
  });
  return model;
}

Model narrowed_within(Model model, UncertainSet uncertain, double per_cent) {
  using verify::Direction;
  for (const std::uint32_t i : uncertain) {
    const auto& [name, unit, description, nominal, range] = model.parameters[i];
    if (nominal == 0.0 && range.width() > 0.0) {
      throw Error(ErrorKind::input,
                  fmt::format("--within: {} is 0 nominally, and no part of that is a range: give it one by --range, or "
                              "leave it out of --uncertain",
                              name));
    }
    const double share = verify::divide(per_cent, 100.0, Direction::up);
    const double off = verify::multiply(std::abs(nominal), share, Direction::up);
    const Enclosure part{std::max(range.lo, verify::subtract(nominal, off, Direction::down)),
                         std::min(range.hi, verify::add(nominal, off, Direction::up))};
    model = narrowed(std::move(model), i, part);
  }
  return model;
}

}  // namespace verisq::stance
