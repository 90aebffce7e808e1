/// Values that certificate files of several kinds hold (docs/formats.md §9).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/files/json_document.hpp"
#include "verisq/certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Each fails at the value that is not such a one.

/// Finite ones.
template <std::size_t N>
[[nodiscard]] std::array<double, N> finite_numbers(const JsonValue& value) {
  if (value.size() != N) value.fail("must be an array of " + std::to_string(N) + " numbers");
  std::array<double, N> result{};
  for (std::size_t k = 0; k < N; ++k) result[k] = value.element(k).number();
  return result;
}

[[nodiscard]] double nonnegative_number(const JsonValue& value);

/// Below 2^32.
[[nodiscard]] std::uint32_t read_index(const JsonValue& value);

/// {"lo", "hi"}, numbers or infinite.
[[nodiscard]] Enclosure read_claim(const JsonValue& value);

/// {"translation", "quaternion"}, which is not zero.
[[nodiscard]] Pose read_pose_object(const JsonValue& value);

/// An array of those that is not empty.
[[nodiscard]] std::vector<Pose> read_path(const JsonValue& value);

/// The digits of one whole cover.
[[nodiscard]] std::vector<bool> read_cover(const JsonValue& value);

/// The keys "normals", "escape", "witness" and "cover" of an object, of which only the first must be there.
[[nodiscard]] Certificate read_certificate(const JsonValue& object);

/// Of the whole document; empty where it has none.
[[nodiscard]] std::string units_of(const JsonValue& root);

}  // namespace verisq
