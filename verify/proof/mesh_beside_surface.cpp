/// On which side of a surface a closed mesh lies, as side_checker.hpp has it: where the two do not meet, one vertex of
/// each of its parts tells; where the surface enters it by no more than a limit, cubes do.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/check_steps.hpp"
#include "verify/proof/mesh_pair_checker.hpp"
#include "verify/proof/side_checker.hpp"

namespace verisq::verify {
namespace {

using Side = OrientedSurface::Side;

/// A checker's work is bounded.
constexpr std::size_t most_cubes = std::size_t{1} << 23U;
/// Cubes that are shared out among threads.
constexpr std::size_t shared_cubes = 4096;
/// In parts of the first cube: smaller ones are not divided.
constexpr double smallest_cube = 0x1p-30;
/// Balls about earlier points that each thread remembers.
constexpr std::size_t remembered_balls = 16;

/// A binary64 point near an exact one. Infinitely far where that overflows.
struct Near {
  Point point;
  double displacement;  ///< at most
};

Near near(const PreciseVector& exact) {
  Near result{{}, infinity};
  for (std::size_t i = 0; i < 3; ++i) result.point[i] = exact[i].lower().to_double(Direction::down);
  if (!is_finite(result.point)) return {{}, infinity};
  result.displacement = length<Real>(PreciseVector(exact - precise(result.point))).upper().to_double(Direction::up);
  return result;
}

/// The closed surface as a mesh of triangles that share no vertices.
Primitive solid_of(const std::vector<Triangle>& triangles) {
  auto mesh = std::make_shared<Mesh>();
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), triangle.begin(), triangle.end());
    mesh->triangles.push_back({first, first + 1, first + 2});
  }
  return {.name = "", .superquadric = {}, .pose = {}, .bend = {}, .mesh = std::move(mesh)};
}

/// Winding numbers of points off a surface. A point in a ball that is free of the surface has that of the ball's
/// centre.
class Windings {
 public:
  explicit Windings(const MeshSolid& solid) : solid_(solid) {}

  /// Precondition: no triangle is nearer to the point than `free`, which is above 0.
  [[nodiscard]] std::optional<int> operator()(const Point& own, double free) {
    const auto* const known =
        std::ranges::find_if(balls_, [&](const Ball& ball) { return distance_up(own, ball.centre) < ball.radius; });
    const std::optional<int> winding =
        known != balls_.end() ? std::optional(known->winding) : solid_.winding_number(precise(own));
    if (winding) balls_[next_++ % remembered_balls] = {own, free, *winding};
    return winding;
  }

 private:
  struct Ball {
    Point centre{};
    double radius = 0.0;
    int winding = 0;
  };

  const MeshSolid& solid_;
  std::array<Ball, remembered_balls> balls_{};
  std::size_t next_ = 0;
};

}  // namespace

MeshBesideSurface::MeshBesideSurface(const Primitive& primitive, const OrientedSurface& surface)
    : mesh_(*primitive.mesh), solid_(primitive), surface_(surface), of_surface_(solid_of(surface.triangles())) {}

Side MeshBesideSurface::side_where(int winding) const {
  if (winding == 0) return Side::outside;
  const bool positive = surface_.faces_outward().value_or(winding < 0);  // of a surface without volume no side is kept
  return (winding > 0) == positive ? Side::inside : Side::neither;
}

/// The side of the mean of the vertices, if that lies deeper than the limit.
std::optional<Side> MeshBesideSurface::side_of_middle(double limit) const {
  Point mean{};
  for (const Point& vertex : mesh_.vertices)
    for (std::size_t i = 0; i < 3; ++i) mean[i] += vertex[i] / static_cast<double>(mesh_.vertices.size());
  if (!is_finite(mean)) return std::nullopt;
  const Point middle = near(solid_.motion()(precise(mean))).point;
  if (!(solid_.signed_distance(middle).hi < -limit)) return std::nullopt;
  return surface_.side_of(middle);
}

SideFinding MeshBesideSurface::operator()(Side wanted, double limit, const CheckOptions& options) const {
  const std::optional<Side> of_middle = side_of_middle(limit);
  if (of_middle && *of_middle != wanted) return SideFinding::other_side;
  const SideFinding finding = kept_wholly(wanted, options);
  if (finding == SideFinding::kept || limit == 0.0) return finding;
  return deep_points_are(wanted, limit, options) ? SideFinding::kept : finding;
}

/// The surface, of one part, does not meet the triangles, and one of its points lies outside: so no point of it lies in
/// the solid. From each point of that a way in it leads to the triangles, and along these to a vertex of their part.
SideFinding MeshBesideSurface::kept_wholly(Side wanted, const CheckOptions& options) const {
  const KeepsOff keeps_off = [&](std::span<const Triangle> triangles) {
    return keep_off_surface(triangles, solid_, options.interrupted);
  };
  if (const std::optional<SideFinding> finding = met(surface_, keeps_off, options)) return *finding;
  if (!(solid_.signed_distance(surface_.triangles().front()[0]).lo > 0.0)) return SideFinding::enters_surface;
  for (const Point& own : solid_.on_parts()) {
    if (options.interrupted()) return SideFinding::on_the_surface;
    const auto [point, displacement] = near(solid_.motion()(precise(own)));
    if (!(of_surface_.tree().nearest(point).distance.lo > displacement)) return SideFinding::on_the_surface;
    const std::optional<int> winding = of_surface_.winding_number(precise(point));
    if (!winding) return SideFinding::on_the_surface;
    if (side_where(*winding) != wanted) return SideFinding::no_deep_point;  // none is known that would refute it
  }
  return SideFinding::kept;
}

// Cubes.

struct MeshBesideSurface::Cube {
  Point centre;
  double half;

  /// Eight that cover it: their centres are rounded.
  [[nodiscard]] std::array<Cube, 8> eighths() const {
    const double quarter = 0.5 * half;
    const double rounding = 0x1p-51 * (largest_coordinate(centre) + half);
    std::array<Cube, 8> result{};
    for (std::size_t n = 0; n < 8; ++n) {
      for (std::size_t i = 0; i < 3; ++i) result[n].centre[i] = centre[i] + ((n >> i & 1U) != 0 ? quarter : -quarter);
      result[n].half = add(quarter, rounding, Direction::up);
    }
    return result;
  }
};

/// Settles cubes: in each no point is deeper than the limit, or all of its points are on the side that is wanted.
class MeshBesideSurface::Settler {
 public:
  Settler(const MeshBesideSurface& of, Side wanted, double limit)
      : of_(of),
        to_mesh_(of.solid_.motion().inverse()),
        wanted_(wanted),
        limit_(limit),
        about_mesh_(of.solid_),
        about_surface_(of.of_surface_) {}

  [[nodiscard]] bool operator()(const Cube& cube) {
    const double radius = multiply(cube.half, square_root(3.0, Direction::up), Direction::up);
    const auto [own, displacement] = near(to_mesh_(precise(cube.centre)));
    if (!(displacement < infinity)) return false;
    const Enclosure to_mesh = of_.solid_.tree().nearest(own).distance;
    const double off = add(radius, displacement, Direction::up);
    if (add(to_mesh.hi, off, Direction::up) <= limit_) return true;
    const double to_surface = of_.of_surface_.tree().nearest(cube.centre).distance.lo;
    const bool is_free = to_surface > radius;
    if (is_free) {
      const std::optional<int> winding = about_surface_(cube.centre, to_surface);
      const bool is_there = winding && of_.side_where(*winding) == wanted_;
      if (is_there && !found_ && to_mesh.lo > displacement) find_depth(own, to_mesh.lo, displacement);
      if (is_there) return true;
    }
    return to_mesh.lo > off && about_mesh_(own, to_mesh.lo) == std::optional(0);
  }

  /// True if a point deeper than the limit was met, on the side that is wanted.
  [[nodiscard]] bool found() const { return found_; }

 private:
  void find_depth(const Point& own, double to_mesh, double displacement) {
    const std::optional<int> winding = about_mesh_(own, to_mesh);
    found_ = winding && *winding != 0 && subtract(to_mesh, displacement, Direction::down) > limit_;
  }

  const MeshBesideSurface& of_;
  RigidMotion to_mesh_;
  Side wanted_;
  double limit_;
  Windings about_mesh_;
  Windings about_surface_;
  bool found_ = false;
};

bool MeshBesideSurface::deep_points_are(Side wanted, double limit, const CheckOptions& options) const {
  const auto [own_centre, own_radius] = solid_.sphere();
  const auto [centre, displacement] = near(solid_.motion()(own_centre));
  const double radius = add(own_radius.upper().to_double(Direction::up), displacement, Direction::up);
  if (!(radius < infinity)) return false;
  std::atomic<std::size_t> cubes = 0;
  std::atomic<bool> failed = false;
  std::atomic<bool> found = false;
  const auto settle = [&](Settler& settler, const Cube& cube, std::vector<Cube>& open) {
    if (settler(cube)) return;
    if (++cubes > most_cubes || cube.half < smallest_cube * radius || options.interrupted()) failed = true;
    std::ranges::copy(cube.eighths(), std::back_inserter(open));
  };
  std::vector<Cube> shared{{centre, radius}};
  while (!shared.empty() && shared.size() < shared_cubes && !failed) {
    Settler settler(*this, wanted, limit);
    const std::vector<Cube> whole = std::exchange(shared, {});
    for (const Cube& cube : whole) settle(settler, cube, shared);
    found = found || settler.found();
  }
  CheckSteps(shared.size(), options).each(shared.size(), [&](std::size_t n) {
    Settler settler(*this, wanted, limit);
    std::vector<Cube> open{shared[n]};
    while (!open.empty() && !failed) {
      const Cube cube = open.back();
      open.pop_back();
      settle(settler, cube, open);
    }
    found = found || settler.found();
  });
  return !failed && !options.interrupted() && found;
}

}  // namespace verisq::verify
