/// Heights are numbers, or those of landmarks.
#include "host/command_line/thickness_option.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "host/command_line/length_option.hpp"
#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr std::string_view option = "--thickness";

Point axis_of(const std::optional<Point>& given, const FemurLandmarks& landmarks) {
  if (given) return *given;
  if (!landmarks.shaft_distal || !landmarks.shaft_proximal) return {0.0, 0.0, 1.0};
  Point axis{};
  for (std::size_t i = 0; i < 3; ++i) axis[i] = (*landmarks.shaft_proximal)[i] - (*landmarks.shaft_distal)[i];
  if (axis == Point{}) refuse("--landmarks: both ends of the shaft are the same point, which has no axis; give --axis");
  return axis;
}

double height_of(const Point& x, const Point& axis) {
  return (x[0] * axis[0] + x[1] * axis[1] + x[2] * axis[2]) / std::hypot(axis[0], axis[1], axis[2]);
}

double height_of(const std::string& at, const std::string& text, const Point& axis, const FemurLandmarks& landmarks) {
  const auto* const named = std::ranges::find_if(named_landmarks, [&at](const auto& one) { return at == one.name; });
  if (named == named_landmarks.end()) return parse_numbers(option, at, "AT").front();
  if (const std::optional<Point>& point = landmarks.*named->point) return height_of(*point, axis);
  refuse(fmt::format("{}: {}: --landmarks has no {}", option, text, at));
}

}  // namespace

CorticalThickness thickness_of(const std::vector<std::string>& texts, const std::optional<Point>& axis,
                               const FemurLandmarks& landmarks) {
  CorticalThickness thickness{.at = {}, .axis = axis_of(axis, landmarks)};
  for (const std::string& text : texts) {
    const std::size_t comma = text.rfind(',');
    if (comma == std::string::npos && texts.size() > 1)
      refuse(fmt::format("{}: {} has no height: of several each is AT,T", option, text));
    const std::string at = comma == std::string::npos ? "0" : text.substr(0, comma);
    const std::string value = comma == std::string::npos ? text : text.substr(comma + 1);
    thickness.at.push_back({height_of(at, text, thickness.axis, landmarks), parse_positive_length(option, value)});
  }
  std::ranges::sort(thickness.at, {}, &ThicknessAtHeight::height);
  const auto twice = std::ranges::adjacent_find(thickness.at, {}, &ThicknessAtHeight::height);
  if (twice != thickness.at.end()) refuse(fmt::format("{}: height {} is given twice", option, twice->height));
  return thickness;
}

}  // namespace verisq::command_line
