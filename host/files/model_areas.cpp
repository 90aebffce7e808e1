/// What the areas of a model file may hold.
#include "host/files/model_areas.hpp"

#include <fmt/format.h>

#include <set>
#include <string>

namespace verisq {
namespace {

Point read_corner(const JsonValue& value) {
  if (value.size() != 3) value.fail("must be an array of 3 numbers");
  return {value.element(0).number(), value.element(1).number(), value.element(2).number()};
}

void check_corners(const JsonValue& box, const AreaBox& area) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(area.lower[k] <= area.upper[k])) {
      box.element(0).element(k).fail(fmt::format("exceeds the upper corner's {}", area.upper[k]));
    }
  }
}

AreaBox read_area_box(const JsonValue& value) {
  value.check_keys({"name", "weight", "box"});
  const JsonValue name = value.at("name");
  const JsonValue weight = value.at("weight");
  const JsonValue box = value.at("box");
  AreaBox area{{name.name(), weight.number()}, {}, {}};
  if (area.area.name == elsewhere) name.fail("is the name of what no area holds");
  if (area.area.weight < 0.0) weight.fail("must not be negative");
  if (box.size() != 2) box.fail("must be an array of 2 corners, [[x0, y0, z0], [x1, y1, z1]]");
  area.lower = read_corner(box.element(0));
  area.upper = read_corner(box.element(1));
  check_corners(box, area);
  return area;
}

}  // namespace

std::vector<AreaBox> read_area_boxes(const JsonValue& areas) {
  std::vector<AreaBox> boxes;
  std::set<std::string> names;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const JsonValue element = areas.element(k);
    boxes.push_back(read_area_box(element));
    if (!names.insert(boxes.back().area.name).second) element.at("name").fail("another area has this name");
  }
  return boxes;
}

}  // namespace verisq
