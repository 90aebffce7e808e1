/// What is asked of each value.
#include "host/files/certificate_fields.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "host/files/cover_digits.hpp"

namespace verisq {
namespace {

/// [primitive, x, y, z]
Normal read_normal(const JsonValue& value) {
  if (value.size() != 4) value.fail("must be the index of a primitive and three numbers");
  return {read_index(value.element(0)),
          {value.element(1).number(), value.element(2).number(), value.element(3).number()}};
}

std::vector<Normal> read_normals(const JsonValue& value) {
  std::vector<Normal> normals;
  for (std::size_t i = 0; i < value.size(); ++i) normals.push_back(read_normal(value.element(i)));
  return normals;
}

std::optional<Point> read_point(const JsonValue& object, std::string_view key) {
  const auto point = object.find(key);
  return point ? std::optional<Point>(finite_numbers<3>(*point)) : std::nullopt;
}

}  // namespace

std::vector<bool> read_cover(const JsonValue& value) {
  auto cover = cover_from(value.text());
  if (!cover) value.fail("must be the hexadecimal digits of a cover");
  return *std::move(cover);
}

Certificate read_certificate(const JsonValue& object) {
  Certificate certificate{read_normals(object.at("normals")), read_point(object, "escape")};
  certificate.witness = read_point(object, "witness");
  if (const auto cover = object.find("cover")) certificate.cover = read_cover(*cover);
  return certificate;
}

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

std::vector<Pose> read_path(const JsonValue& value) {
  if (value.size() == 0) value.fail("must not be empty");
  std::vector<Pose> path;
  for (std::size_t k = 0; k < value.size(); ++k) path.push_back(read_pose_object(value.element(k)));
  return path;
}

std::string units_of(const JsonValue& root) {
  const auto units = root.find("units");
  return units ? units->line() : std::string();
}

}  // namespace verisq
