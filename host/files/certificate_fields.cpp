/// What is asked of each value.
#include "host/files/certificate_fields.hpp"

#include <algorithm>

namespace verisq {

double nonnegative_number(const JsonValue& value) {
  const double number = value.number();
  if (number < 0.0) value.fail("must be at least 0");
  return number;
}

std::uint32_t read_index(const JsonValue& value) {
  if (!value.json().is_number_unsigned() || value.json().get<std::uint64_t>() > 0xffffffffU) {
    value.fail("must be an index");
  }
  return value.json().get<std::uint32_t>();
}

Enclosure read_claim(const JsonValue& value) {
  value.check_keys({"lo", "hi"});
  return {value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()};
}

Pose read_pose_object(const JsonValue& value) {
  value.check_keys({"translation", "quaternion"});
  const Pose pose{finite_numbers<3>(value.at("translation")), finite_numbers<4>(value.at("quaternion"))};
  if (std::ranges::all_of(pose.quaternion, [](double c) { return c == 0.0; })) {
    value.at("quaternion").fail("must not be zero");
  }
  return pose;
}

std::string units_of(const JsonValue& root) {
  const auto units = root.find("units");
  return units ? units->line() : std::string();
}

}  // namespace verisq
