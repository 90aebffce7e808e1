/// What named points may be.
#include "host/files/landmark_points.hpp"

#include <algorithm>
#include <string>

namespace verisq {
namespace {

Point coordinates(const JsonValue& value) {
  if (value.size() != 3) value.fail("must be an array of 3 numbers");
  return {value.element(0).number(), value.element(1).number(), value.element(2).number()};
}

}  // namespace

FemurLandmarks read_landmark_points(const JsonValue& points) {
  if (!points.json().is_object()) points.fail("must be an object");
  FemurLandmarks landmarks;
  for (auto item = points.json().begin(); item != points.json().end(); ++item) {
    const std::string& key = item.key();
    const JsonValue value = points.at(key);
    const auto* const known =
        std::ranges::find_if(named_landmarks, [&](const NamedLandmark& l) { return key == l.name; });
    if (known == named_landmarks.end()) value.fail("is no landmark");
    landmarks.*(known->point) = coordinates(value);
  }
  return landmarks;
}

std::optional<Side> read_side(const JsonValue& object) {
  const auto value = object.find("side");
  if (!value) return std::nullopt;
  const std::string text = value->text();
  if (text != "left" && text != "right") value->fail("must be \"left\" or \"right\"");
  return text == "left" ? Side::left : Side::right;
}

}  // namespace verisq
