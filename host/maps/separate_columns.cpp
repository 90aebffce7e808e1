/// This file implements the comparison of columns as arithmetic progressions of addresses.
#include "host/maps/separate_columns.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace verisq {
namespace {

/// The addresses of a column's values, from the lowest on.
struct Progression {
  std::uintptr_t first;
  std::uintptr_t stride;
  std::uintptr_t bytes;  // of a value
  std::uintptr_t end;    // of the last value
};

template <class Value>
Progression progression(const Column<Value>& column, std::size_t size) {
  const auto one = reinterpret_cast<std::uintptr_t>(&column[0]);
  const auto other = reinterpret_cast<std::uintptr_t>(&column[size - 1]);
  const auto stride = static_cast<std::uintptr_t>(column.stride < 0 ? -column.stride : column.stride);
  return {std::min(one, other), stride * sizeof(Value), sizeof(Value), std::max(one, other) + sizeof(Value)};
}

bool apart(const Progression& a, const Progression& b) {
  if (a.end <= b.first || b.end <= a.first) return true;
  if (a.stride != b.stride || a.stride == 0) return false;
  // Where b's values begin in a's periods.
  const std::uintptr_t beyond =
      b.first >= a.first ? (b.first - a.first) % a.stride : (a.stride - (a.first - b.first) % a.stride) % a.stride;
  return beyond >= a.bytes && beyond + b.bytes <= a.stride;
}

}  // namespace

void require_apart(const PointColumns& points, const ResultColumns& rows) {
  const std::size_t size = points.size();
  if (size == 0) return;
  const std::array results{progression(rows.lo(), size), progression(rows.hi(), size),
                           progression(rows.status(), size)};
  for (const Column<const double>& column : points.coordinates()) {
    const Progression coordinates = progression(column, size);
    if (!std::ranges::all_of(results, [&](const Progression& result) { return apart(coordinates, result); }))
      throw Error(ErrorKind::input, "the columns of the rows share memory with those of the coordinates");
  }
  if (!apart(results[0], results[1]) || !apart(results[0], results[2]) || !apart(results[1], results[2]))
    throw Error(ErrorKind::input, "the columns of the rows share memory with each other");
}

}  // namespace verisq
