/// Steps are halved where the surface leaves the chord between two grid lines.
#include "host/tessellation/parametric_surface.hpp"

#include <algorithm>
#include <functional>
#include <vector>

namespace verisq::tessellation {
namespace {

/// Of the deviation: the two directions' add up.
constexpr double share_of_a_chord = 0.45;
constexpr int deepest_halving = 40;
/// Across the lines of one family, where its chords are looked at.
constexpr int lines_looked_at = 32;

using CurvePoint = std::function<Eigen::Vector3d(double parameter, double across)>;

class GridOfChords {
 public:
  GridOfChords(CurvePoint point, std::vector<double> across, double sag)
      : point_(std::move(point)), across_(std::move(across)), sag_(sag) {}

  /// From `first` to `last` eighths of a turn, both included: multiples of 1/2 are where edges and corners may lie.
  [[nodiscard]] std::vector<double> between(int first, int last) {
    grid_ = {first / 2.0};
    for (int eighth = first; eighth < last; ++eighth) halve(eighth / 2.0, (eighth + 1) / 2.0, 0);
    return grid_;
  }

 private:
  void halve(double a, double b, int depth) {
    if (depth < deepest_halving && leaves_chord(a, b)) {
      halve(a, (a + b) / 2.0, depth + 1);
      halve((a + b) / 2.0, b, depth + 1);
    } else {
      grid_.push_back(b);
    }
  }

  [[nodiscard]] bool leaves_chord(double a, double b) const {
    return std::ranges::any_of(across_, [&](double across) {
      const Eigen::Vector3d from = point_(a, across);
      const Eigen::Vector3d chord = point_(b, across) - from;
      if (chord.norm() <= sag_) return false;  // nothing between lies farther away
      const std::array inner{0.25, 0.5, 0.75};
      return std::ranges::any_of(inner, [&](double t) {
        const Eigen::Vector3d way = point_(a + t * (b - a), across) - from;
        const double along = std::clamp(way.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
        return (way - along * chord).norm() > sag_;
      });
    });
  }

  CurvePoint point_;
  std::vector<double> across_;
  double sag_;
  std::vector<double> grid_;
};

/// Evenly spread, with the ends and all multiples of 1/2.
std::vector<double> lines_across(double first, double last) {
  std::vector<double> lines;
  for (int i = 0; i <= lines_looked_at; ++i) lines.push_back(first + (last - first) * i / lines_looked_at);
  return lines;
}

struct Grid {
  std::vector<double> longitudes;  // 0 to 4; the last one is the first again
  std::vector<double> latitudes;   // -1 to 1: the poles
};

Grid grid_of(const PlacedPrimitive& primitive, double deviation) {
  const double sag = share_of_a_chord * deviation;
  const auto by_longitude = [&](double longitude, double latitude) {
    return primitive.surface_point({longitude, latitude});
  };
  const auto by_latitude = [&](double latitude, double longitude) {
    return primitive.surface_point({longitude, latitude});
  };
  GridOfChords around(by_longitude, lines_across(-1.0, 1.0), sag);
  GridOfChords along(by_latitude, lines_across(0.0, 4.0), sag);
  return {around.between(0, 8), along.between(-2, 2)};
}

}  // namespace

Mesh parametric_surface(const PlacedPrimitive& primitive, double deviation) {
  const auto [longitudes, latitudes] = grid_of(primitive, deviation);
  const auto columns = static_cast<std::uint32_t>(longitudes.size() - 1);
  const auto rows = static_cast<std::uint32_t>(latitudes.size() - 2);  // without the poles
  Mesh mesh;
  const auto add_vertex = [&](double longitude, double latitude) {
    const Eigen::Vector3d point = primitive.surface_point({longitude, latitude});
    mesh.vertices.push_back({point[0], point[1], point[2]});
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) add_vertex(longitudes[column], latitudes[row + 1]);
  }
  add_vertex(0.0, -1.0);
  add_vertex(0.0, 1.0);
  const std::uint32_t south = rows * columns;
  const std::uint32_t north = south + 1;
  for (std::uint32_t column = 0; column < columns; ++column) {
    const std::uint32_t next = (column + 1) % columns;
    mesh.triangles.push_back({south, next, column});
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
      const std::uint32_t low = row * columns;
      const std::uint32_t high = low + columns;
      mesh.triangles.push_back({low + column, low + next, high + next});
      mesh.triangles.push_back({low + column, high + next, high + column});
    }
    const std::uint32_t last = (rows - 1) * columns;
    mesh.triangles.push_back({last + column, last + next, north});
  }
  return mesh;
}

}  // namespace verisq::tessellation
