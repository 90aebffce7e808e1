/// The middle of the bounding box, and half of its diagonal.
#include "verify/sets/solid_extent.hpp"

#include "verify/sets/bounding_box.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::verify {

SolidExtent extent_of(const Model& model) {
  const Box box = bounding_box(model);
  Point centre{};
  for (std::size_t i = 0; i < 3; ++i) centre[i] = 0.5 * box.lower[i] + 0.5 * box.upper[i];
  return {centre, bounding_radius(model)};
}

}  // namespace verisq::verify
