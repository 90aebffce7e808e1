/// Compares a picture with the mesh and the rows that it should show.
#include "host/files/map_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <bit>
#include <cstddef>
#include <string>
#include <string_view>

#include "host/files/finite_middle.hpp"

namespace verisq {
namespace {

std::string text(double number) {
  return fmt::format("{:.17g}", number);  // 17 significant digits give back the same binary64
}

std::string text(std::int64_t number) {
  return fmt::format("{}", number);
}

std::string text(const Point& point) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", point[0], point[1], point[2]);
}

std::string text(const std::array<std::int64_t, 3>& corners) {
  return fmt::format("({})", fmt::join(corners, ", "));
}

std::optional<MapDifference> difference_of_counts(std::string_view name, std::size_t shown, std::size_t expected) {
  if (shown == expected) return std::nullopt;
  return MapDifference{std::string(name), std::nullopt, fmt::format("{}", shown), fmt::format("{}", expected)};
}

/// `expected(k)` is what the k-th should be. Bits, not values: 0 is not -0.
template <class Item, class Expected>
std::optional<MapDifference> first_difference(std::string_view name, std::span<const Item> shown,
                                              const Expected& expected) {
  using Bits = std::array<std::byte, sizeof(Item)>;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Item item = expected(k);
    if (std::bit_cast<Bits>(shown[k]) != std::bit_cast<Bits>(item)) {
      return MapDifference{std::string(name), k, text(shown[k]), text(item)};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<MapDifference> MapPicture::difference_from(const Mesh& mesh, MapElements elements,
                                                         std::span<const double> lo, std::span<const double> hi) const {
  const bool has_triangles = elements == MapElements::triangles || !mesh.triangles.empty();
  const std::int64_t corners = has_triangles ? 3 : 1;
  if (auto found = difference_of_counts("NumberOfPoints", points.size(), mesh.vertices.size())) return found;
  if (auto found = difference_of_counts("NumberOfPolys", triangles.size(), mesh.triangles.size())) return found;
  if (auto found = first_difference<Point>("Points", points, [&](std::size_t k) { return mesh.vertices[k]; })) {
    return found;
  }
  const auto corners_of = [&](std::size_t k) {
    const auto& [a, b, c] = mesh.triangles[k];
    return std::array<std::int64_t, 3>{a, b, c};
  };
  if (auto found = first_difference<std::array<std::int64_t, 3>>("connectivity", triangles, corners_of)) return found;
  if (auto found = first_difference<std::int64_t>("connectivity", vertex_cells,
                                                  [](std::size_t k) { return static_cast<std::int64_t>(k); })) {
    return found;
  }
  if (auto found = first_difference<std::int64_t>(
          "offsets", offsets, [&](std::size_t k) { return corners * static_cast<std::int64_t>(k + 1); })) {
    return found;
  }
  return first_difference<double>("dist_mid", middles, [&](std::size_t k) { return finite_middle(lo[k], hi[k]); });
}

}  // namespace verisq
