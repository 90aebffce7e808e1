/// Whether points lie inside a closed surface, in floating point: fast enough for every pose that a search looks at.
#pragma once

#include <cstdint>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::fit_search {

/// By rays along z, which meet the triangles of one column of a grid over the x-y plane alone. A ray that grazes an
/// edge may be told wrongly: nothing is proven.
class InsideTest {
 public:
  /// The mesh, closed over its rims. Precondition: as closing_over_rims.
  explicit InsideTest(const Mesh& mesh);

  [[nodiscard]] bool operator()(const Point& point) const;

 private:
  [[nodiscard]] std::size_t column(double along, std::size_t axis) const;
  void add(std::uint32_t triangle);

  std::vector<Triangle> triangles_;
  Point lower_{};
  Point upper_{};
  std::vector<std::vector<std::uint32_t>> columns_;
};

}  // namespace verisq::fit_search
