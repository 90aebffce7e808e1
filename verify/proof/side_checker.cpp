/// This file implements side_checker.hpp.
#include "verify/proof/side_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "verify/proof/check_steps.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/clearance.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// A checker's work is bounded: so many cases, and more of them for each triangle.
constexpr std::size_t most_cases = 2048;
constexpr std::size_t most_cases_a_triangle = 64;
/// Share of the largest semi-axis: smaller parts of triangles are not halved any more.
constexpr double smallest_extent = 0x1p-30;
/// Share of the smallest semi-axis: the centre must be deeper than the limit by this. Balls that nearly touch the
/// surface take long to prove.
constexpr double depth_to_spare = 0x1p-10;
/// GJK must find a direction, not a distance.
constexpr GjkTolerance<double> rough{.relative = 1e-6, .absolute = 0.0, .most_steps = 40};

using Plain = Coordinates<double>;

PreciseInterval curvature_of(const Primitive& primitive) {
  return is_bent(primitive) ? abs(PreciseInterval(Real(primitive.bend->curvature))) : PreciseInterval(0);
}

Plain about(const PreciseVector& v) {
  return {v[0].lower().to_double(Direction::down), v[1].lower().to_double(Direction::down),
          v[2].lower().to_double(Direction::down)};
}

double distance(const Plain& a, const Plain& b) {
  const Plain way = difference(b, a);
  return std::sqrt(dot(way, way));
}

/// About how far apart they are: the diagonal of their box.
template <class Corners>
double extent_of(const Corners& corners) {
  Plain lower = corners[0].about;
  Plain upper = lower;
  for (const auto& corner : corners) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], corner.about[i]);
      upper[i] = std::max(upper[i], corner.about[i]);
    }
  }
  return distance(lower, upper);
}

/// The longest side of a triangle, from corner to corner.
template <class Corners>
std::pair<std::size_t, std::size_t> longest_side(const Corners& corners) {
  std::pair<std::size_t, std::size_t> longest{0, 1};
  for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{1, 2}, {2, 0}}) {
    if (distance(corners[from].about, corners[to].about) >
        distance(corners[longest.first].about, corners[longest.second].about))
      longest = {from, to};
  }
  return longest;
}

/// Let x be deeper than L in a bent primitive. Its distance from the axis about which the bend turns is above w = (1 -
/// ke)/k + L with e >= max |r|, since x and the point L nearer to the axis lie in the primitive. The point y at the
/// distance L from x lies in it, too. On the way the angle about the axis changes continuously, by less than asin(L/w),
/// which is at most u/√(1 - u²), u = L/w. The height before the bend changes by a k-th of that:
///     L/(1 - ke + kL)/√(1 - u²),  u = kL/(1 - ke + kL).
double height_beyond(const Primitive& primitive, double limit) {
  if (!is_bent(primitive)) return 0.0;
  const PreciseInterval k = curvature_of(primitive);
  const PreciseInterval length{Real(limit)};
  const PreciseInterval nearest = PreciseInterval(1) - k * extent(*primitive.bend, primitive.superquadric) + k * length;
  const PreciseInterval u = k * length / nearest;
  return (length / (nearest * sqrt(PreciseInterval(1) - square(u)))).upper().to_double(Direction::up);
}

}  // namespace

DeepPart::DeepPart(const Primitive& primitive, double limit)
    : primitive_(primitive),
      limit_(limit),
      sections_(primitive),
      mapping_(primitive),
      nearest_(primitive.superquadric),
      focus_(focus(primitive.superquadric)[2].lower().to_double(Direction::down)),
      beyond_(height_beyond(primitive, limit)) {}

bool DeepPart::is_connected() const {
  return !is_bent(primitive_) || is_connected_below(limit_, *primitive_.bend, primitive_.superquadric);
}

/// Consider the ball of radius ρ about the bent centre, where W = 1. Along a segment from there W >= 1 - kρ, so no step
/// is longer before the bend than by 1/(1 - kρ). So the points that the bend maps into the ball lie in the ball of
/// radius ρ/(1 - kρ).
bool DeepPart::holds_centre(const Hook& interrupted) const {
  const Superquadric& solid = primitive_.superquadric;
  const double radius = limit_ + depth_to_spare * std::ranges::min(solid.semi_axes);
  if (!(radius > limit_)) return false;
  const PreciseInterval exact{Real(radius)};
  const PreciseInterval stretch = PreciseInterval(1) - curvature_of(primitive_) * exact;
  if (!(stretch.lower() > Real(0))) return false;
  const double unbent = (exact / stretch).upper().to_double(Direction::up);
  return std::isfinite(unbent) &&
         contains_ball(solid, SuperquadricBounds<Real>(solid), -focus(solid), unbent, interrupted);
}

/// Heights are heights of the whole primitive, -a3 to a3, as is_connected_below and the bend require.
PosedSections::Section DeepPart::widened(const PosedSections::Section& section) const {
  const auto [lowest, highest] = sections_.whole();
  return {std::max(lowest, subtract(section.lower, beyond_, Direction::down)),
          std::min(highest, add(section.upper, beyond_, Direction::up))};
}

/// Let x of the section lie deeper than L, so that a point beyond x + L n/|n| still lies in the primitive, at a height
/// of the widened section. Then n·x + L |n| is below the reach of that section. If all corners have at least as much,
/// no point of their triangles is such an x.
bool DeepPart::are_apart(const Case& part) const {
  const PosedSections::Section section = widened(part.section);
  const SectionMapping::Section plain = mapping_.section(section.lower, section.upper);
  const std::optional<Plain> n = proposed_normal(part.corners, plain);
  const double slope = n ? mapping_.slope(*n, plain) : 0.0;
  if (!n || !std::isfinite(slope)) return false;
  const PreciseVector normal = precise(*n);
  const PreciseInterval reach(sections_.reach(normal, section, slope));
  const PreciseInterval inward = PreciseInterval(Real(limit_)) * length<Real>(normal);
  const Real least = (reach - inward).upper();
  return std::ranges::all_of(part.corners,
                             [&](const Corner& corner) { return normal.dot(corner.exact).lower() >= least; });
}

bool DeepPart::keeps_off(std::span<const Triangle> triangles, const Hook& interrupted) const {
  Corners corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (const Point& corner : triangle) {
      const PreciseVector local = sections_.motion().local_point(corner);
      corners.push_back({local, about(local)});
    }
  }
  std::vector<Case> open{{std::move(corners), sections_.whole()}};
  for (std::size_t cases = 0; !open.empty(); ++cases) {
    if (interrupted && interrupted()) return false;
    const Case part = std::move(open.back());
    open.pop_back();
    if (part.corners.empty() || are_apart(part)) continue;
    Halves both = halves(part);
    if (!both || cases >= most_cases + most_cases_a_triangle * triangles.size()) return false;
    for (Case& half : *both) open.push_back(std::move(half));
  }
  return true;
}

/// The halves of the section if it is longer; else of the triangles, or of the one triangle across its longest side.
DeepPart::Halves DeepPart::halves(const Case& part) const {
  const auto& [corners, section] = part;
  const double extent = extent_of(corners);
  if (is_bent(primitive_) && section.upper - section.lower >= extent) {
    const auto sections = verify::halves(section);
    if (!sections) return std::nullopt;
    return std::array{Case{corners, (*sections)[0]}, Case{corners, (*sections)[1]}};
  }
  if (corners.size() > 3) {
    const auto middle = corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 6 * 3);
    return std::array{Case{{corners.begin(), middle}, section}, Case{{middle, corners.end()}, section}};
  }
  if (!(extent > smallest_extent * std::ranges::max(primitive_.superquadric.semi_axes))) return std::nullopt;
  const auto [from, to] = longest_side(corners);
  const PreciseVector middle = (corners[from].exact + corners[to].exact) / PreciseInterval(2);
  std::array both{part, part};
  both[0].corners[to] = both[1].corners[from] = {middle, about(middle)};
  return both;
}

// --- Proposals ---

/// The normal of the surface at its nearest point.
Coordinates<double> DeepPart::normal_near(const Plain& x) const {
  const Plain unbent = mapping_.unbent(x);
  return mapping_.bent_normal(nearest_({unbent[0], unbent[1], unbent[2] - focus_}).normal, unbent);
}

/// GJK's normal if there is a gap; if a triangle enters the primitive, the triangle's own normal or the surface's.
std::optional<Point> DeepPart::proposed_normal(const Corners& corners, const SectionMapping::Section& section) const {
  const auto of_section = [&](const Plain& v) { return mapping_.support_point(v, section); };
  const auto of_corners = [&](const Plain& v) {
    return std::ranges::max_element(corners, {}, [&](const Corner& corner) { return dot(v, corner.about); })->about;
  };
  BestNormal best(of_section, of_corners);
  best.offer(gjk<double>(of_section, of_corners, corners[0].about, rough).separation);
  if (best.gap() < -limit_ && corners.size() == 3) {
    const std::array vertices{corners[0].about, corners[1].about, corners[2].about};
    const auto& [a, b, c] = vertices;
    best.offer_normals_of(vertices);
    best.offer(normal_near({(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0}));
    for (const Plain& vertex : vertices) best.offer(normal_near(vertex));
  }
  const Plain& n = best.normal();
  if (!(best.gap() >= -limit_) || !usable({n[0], n[1], n[2]})) return std::nullopt;
  return n;
}

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  ///< the lower index first

/// The runs through one edge.
struct Runs {
  int forward = 0;   ///< from the lower index to the higher one
  int backward = 0;  ///<
};

std::map<Edge, Runs> runs_through(const Mesh& mesh) {
  std::map<Edge, Runs> edges;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corners[i];
      const std::uint32_t to = corners[(i + 1) % 3];
      if (from == to) throw Error(ErrorKind::input, "has no sides: a triangle uses a vertex twice");
      Runs& runs = edges[std::minmax(from, to)];
      ++(from < to ? runs.forward : runs.backward);
    }
  }
  return edges;
}

/// The rims of the mesh are closed walks only if `require_sides` passes.
Closing closing_of(const Mesh& mesh) {
  require_sides(mesh);
  return closing_over_rims(mesh);
}

/// The number of connected components of the triangles, by the edges that they share.
std::size_t components_of(const Mesh& mesh) {
  std::vector<std::size_t> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t n) {
    while (root[n] != n) n = root[n] = root[root[n]];
    return n;
  };
  std::map<Edge, std::size_t> first_of;
  std::size_t components = root.size();
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& corners = mesh.triangles[n];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [place, is_new] = first_of.emplace(std::minmax(corners[i], corners[(i + 1) % 3]), n);
      const std::size_t one = find(n);
      const std::size_t other = find(place->second);
      if (is_new || one == other) continue;
      root[one] = other;
      --components;
    }
  }
  return components;
}

}  // namespace

void require_sides(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "has no triangles, so that it has no sides");
  for (const auto& [edge, runs] : runs_through(mesh)) {
    if (runs.forward > 1 || runs.backward > 1) {
      throw Error(ErrorKind::input,
                  "has no sides: edges of more than two triangles, or triangles that are not turned alike");
    }
  }
}

OrientedSurface::OrientedSurface(const Mesh& mesh)
    : closing_(closing_of(mesh)),
      components_(components_of(mesh)),
      closed_(closed_triangles(mesh, closing_)),
      orientation_(orientation_of(closed_.triangles())) {
  if (!is_closed(closed_.triangles())) throw Error(ErrorKind::failure, "a surface is not closed over its rims");
}

std::optional<OrientedSurface::Side> OrientedSurface::side_of(const Point& point) const {
  const std::optional<int> winding = closed_.winding_number(point);
  if (!winding) return std::nullopt;
  if (*winding == 0) return Side::outside;
  if (!orientation_) return std::nullopt;
  return *winding * *orientation_ > 0 ? Side::inside : Side::neither;
}

namespace {

constexpr std::size_t triangles_a_task = 32;

/// Neighbours in a mesh are often near each other.
bool keep_off(const KeepsOff& keeps_off, std::span<const Triangle> triangles, const CheckOptions& options) {
  const std::size_t tasks = (triangles.size() + triangles_a_task - 1) / triangles_a_task;
  std::atomic<std::size_t> kept = 0;  // tasks; one that is not begun is not kept
  std::atomic<bool> failed = false;
  CheckSteps(tasks, options).each(tasks, [&](std::size_t task) {
    const std::size_t first = task * triangles_a_task;
    if (failed) return;
    if (keeps_off(triangles.subspan(first, std::min(triangles_a_task, triangles.size() - first))))
      ++kept;
    else
      failed = true;
  });
  return kept == tasks;
}

}  // namespace

std::optional<SideFinding> met(const OrientedSurface& surface, const KeepsOff& keeps_off, const CheckOptions& options) {
  const std::span<const Triangle> triangles = surface.triangles();
  if (!keep_off(keeps_off, triangles.first(surface.triangles_of_mesh()), options)) return SideFinding::enters_surface;
  if (!keep_off(keeps_off, triangles.subspan(surface.triangles_of_mesh()), options))
    return SideFinding::reaches_through;
  return std::nullopt;
}

}  // namespace verisq::verify

namespace verisq {

namespace {

using PointSide = verify::OrientedSurface::Side;

PointSide wanted_side(const SideClaim& claim) {
  return claim.side == SurfaceSide::inside ? PointSide::inside : PointSide::outside;
}

}  // namespace

struct SideChecker::State {
  State(const Model& m, const Mesh& mesh, double limit) : model(m), surface(mesh), penetration_limit(limit) {}

  [[nodiscard]] SideFinding of_convex_or_bent(const SideClaim& claim, const CheckOptions& options) const;

  Model model;
  verify::OrientedSurface surface;
  double penetration_limit;
};

SideChecker::SideChecker(const Model& model, const Mesh& surface, double penetration_limit) {
  if (!(penetration_limit >= 0.0) || !std::isfinite(penetration_limit)) {
    throw Error(ErrorKind::input,
                fmt::format("sides: penetration limit: must be finite and at least 0, not {}", penetration_limit));
  }
  verify::require_valid_with_meshes(model);
  state_ = hidden<State>(model, surface, penetration_limit);
}

std::optional<bool> SideChecker::faces_outward() const {
  return state_->surface.faces_outward();
}

std::size_t SideChecker::rims() const {
  return state_->surface.rims();
}

Verdict verdict_of(SideFinding finding) {
  if (finding == SideFinding::kept) return Verdict::proved;
  return finding == SideFinding::other_side ? Verdict::refuted : Verdict::unproved;
}

SideFinding SideChecker::State::of_convex_or_bent(const SideClaim& claim, const CheckOptions& options) const {
  const Primitive& primitive = model.primitives[claim.primitive];
  const verify::DeepPart part(primitive, penetration_limit);
  if (!part.holds_centre(options.interrupted)) return SideFinding::no_deep_point;
  if (!part.is_connected()) return SideFinding::strongly_bent;
  const std::optional<PointSide> side = surface.side_of(primitive.pose.translation);
  if (!side) return SideFinding::on_the_surface;
  if (*side != wanted_side(claim)) return SideFinding::other_side;
  const auto keeps_off = [&](std::span<const Triangle> triangles) {
    return part.keeps_off(triangles, options.interrupted);
  };
  return verify::met(surface, keeps_off, options).value_or(SideFinding::kept);
}

SideFinding SideChecker::operator()(const SideClaim& claim, const CheckOptions& options) const {
  if (claim.side == SurfaceSide::any) return SideFinding::kept;
  const verify::OrientedSurface& surface = state_->surface;
  const Primitive& primitive = state_->model.primitives[claim.primitive];
  const SideFinding finding = primitive.mesh ? verify::MeshBesideSurface(primitive, surface)(
                                                   wanted_side(claim), state_->penetration_limit, options)
                                             : state_->of_convex_or_bent(claim, options);
  if (finding != SideFinding::kept) return finding;
  if (surface.components() > 1) return SideFinding::several_parts;
  return surface.faces_outward() ? SideFinding::kept : SideFinding::no_volume;
}

}  // namespace verisq
