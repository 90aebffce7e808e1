/// Makes a bone with a known answer: the closed surface of a cavity, every vertex of which is the given distance from
/// the implant where its file places it. `cavity stem_mm.json 2 cavity.off` made examples/cavity.off.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

namespace {

using verisq::Point;

constexpr std::uint32_t around = 16;      // vertices of a ring
constexpr std::uint32_t cap_rings = 4;    // between each pole and the end of the axis
constexpr std::uint32_t axis_rings = 41;  // along the axis
constexpr std::uint32_t rings = axis_rings + 2 * cap_rings;

/// start + length * direction
Point along(const Point& start, const Point& direction, double length) {
  return {start[0] + length * direction[0], start[1] + length * direction[1], start[2] + length * direction[2]};
}

Point difference(const Point& a, const Point& b) {
  return along(a, b, -1.0);
}

double length(const Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}

/// `end`, and as far beyond it, seen from `before`, as this primitive is longer than wide.
Point drawn_out(const Point& before, const verisq::Primitive& end) {
  const Point direction = difference(end.pose.translation, before);
  const auto& [a1, a2, a3] = end.superquadric.semi_axes;
  return along(end.pose.translation, direction, std::max(a3 - std::max(a1, a2), 0.0) / length(direction));
}

/// Through the centres of all primitives, in the order of the file.
std::vector<Point> axis_of(const verisq::Model& implant) {
  if (implant.primitives.size() < 2) throw verisq::Error(verisq::ErrorKind::input, "an axis needs two primitives");
  std::vector<Point> axis;
  for (const verisq::Primitive& primitive : implant.primitives) axis.push_back(primitive.pose.translation);
  const Point first = drawn_out(axis[1], implant.primitives.front());
  axis.back() = drawn_out(axis[axis.size() - 2], implant.primitives.back());
  axis.front() = first;
  return axis;
}

/// The point at the share `t` in [0, 1] of the way along the polyline.
Point point_on(const std::vector<Point>& polyline, double t) {
  double total = 0.0;
  for (std::size_t n = 1; n < polyline.size(); ++n) total += length(difference(polyline[n], polyline[n - 1]));
  double left = t * total;
  for (std::size_t n = 1; n < polyline.size(); ++n) {
    const Point edge = difference(polyline[n], polyline[n - 1]);
    if (left <= length(edge)) return along(polyline[n - 1], edge, left / length(edge));
    left -= length(edge);
  }
  return polyline.back();
}

/// Comes from far outside towards `centre`, a point of the implant, and stops at the distance `gap` from it: sphere
/// tracing, whose steps are as long as the surface is proven to be away.
Point vertex(const verisq::SignedDistance& distance, const Point& centre, const Point& direction, double far,
             double gap) {
  constexpr int most_steps = 100'000;
  double reached = far;
  for (int step = 0; step < most_steps; ++step) {
    const Point point = along(centre, direction, reached);
    const double left = distance(point, 0.0).lo - gap;
    if (left <= 1e-14 * far) return point;
    reached -= left;
  }
  throw verisq::Error(verisq::ErrorKind::failure, "no point at the wanted distance");
}

/// A pole, rings of vertices, the other pole; no triangles yet. The implant does not lie along the y axis.
verisq::Mesh vertices_around(const verisq::Model& implant, double gap) {
  const verisq::SignedDistance distance(implant);
  const std::vector<Point> axis = axis_of(implant);
  const double far = gap + 2.0 * verisq::bounding_radius(implant);
  const Point whole = difference(axis.back(), axis.front());
  const Point up = along({}, whole, 1.0 / length(whole));
  const Point beside{up[2] / std::hypot(up[0], up[2]), 0.0, -up[0] / std::hypot(up[0], up[2])};
  const Point before{up[1] * beside[2], up[2] * beside[0] - up[0] * beside[2], -up[1] * beside[0]};

  verisq::Mesh mesh;
  mesh.vertices.push_back(vertex(distance, axis.front(), along({}, up, -1.0), far, gap));
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    const double place = static_cast<double>(ring) - cap_rings;  // of the ring on the axis, which ends at `last`
    constexpr double last = axis_rings - 1;
    const double on_axis = std::clamp(place, 0.0, last);
    const Point centre = point_on(axis, on_axis / last);
    const double elevation = (place - on_axis) / (cap_rings + 1) * std::numbers::pi / 2.0;
    for (std::uint32_t k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      const Point sideways = along(along({}, beside, std::cos(angle)), before, std::sin(angle));
      const Point direction = along(along({}, sideways, std::cos(elevation)), up, std::sin(elevation));
      mesh.vertices.push_back(vertex(distance, centre, direction, far, gap));
    }
  }
  mesh.vertices.push_back(vertex(distance, axis.back(), up, far, gap));
  return mesh;
}

/// Each ring to the next, normals outward.
void add_triangles(verisq::Mesh& mesh) {
  const auto at = [](std::uint32_t ring, std::uint32_t k) { return 1 + ring * around + k % around; };
  const std::uint32_t last = 1 + rings * around;
  for (std::uint32_t k = 0; k < around; ++k) mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t k = 0; k < around; ++k) {
      mesh.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    }
  }
  for (std::uint32_t k = 0; k < around; ++k) mesh.triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), last});
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: cavity IMPLANT.json DISTANCE OUT.off\n");
    return 2;
  }
  try {
    verisq::Mesh mesh = vertices_around(verisq::read_model(arguments[1]), std::stod(arguments[2]));
    add_triangles(mesh);
    verisq::write_mesh(arguments[3], mesh);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cavity: %s\n", error.what());
    return 1;
  }
  return 0;
}
