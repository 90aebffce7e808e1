/// The bone that an insertion takes away: its volume, enclosed and certified, and where bone is.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <utility>
#include <verisq/clearance.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/errors/refusal.hpp"
#include "host/plan/clearance.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/search/clipped_cube.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/insertion.hpp"

namespace verisq {
namespace {

using verify::ClippedCube;
using verify::Cube;
using verify::CubePart;
using verify::CuttingPlane;
using verify::Direction;
using verify::DividedSurface;
using verify::Interval;
using verify::MovingPrimitive;
using verify::SweptPart;
using verify::TimeStretch;

/// Centres of cubes stay exact: they have 10 bits below the root's half-width, and one more a level.
constexpr double centre_bits = 0x1p10;
constexpr int deepest_level = 30;
/// Share of the tolerance for the cubes that are not divided in a round.
constexpr double share_of_rest = 0.5;
/// Cubes that are divided between two polls.
constexpr std::size_t cubes_between_polls = 256;

Enclosure sum(const Enclosure& a, const Enclosure& b) {
  return {verify::add(a.lo, b.lo, Direction::down), verify::add(a.hi, b.hi, Direction::up)};
}

/// The volume of a set without a part of it.
Enclosure rest(const Enclosure& whole, const Enclosure& part) {
  return {std::max(0.0, verify::subtract(whole.lo, part.hi, Direction::down)),
          std::max(0.0, verify::subtract(whole.hi, part.lo, Direction::up))};
}

/// A primitive that a part of the path may bring into the cube.
struct NearPrimitive {
  std::uint32_t primitive;
  std::vector<TimeStretch> stretches;
};

struct RegionCube {
  Cube cube{};
  int level = 0;
  std::uint32_t place = 0;  ///< place in the tree of all cubes
  std::vector<NearPrimitive> primitives = {};
  std::vector<DividedSurface::Piece> surfaces = {};
  Enclosure removed{0.0, 0.0};
};

/// Bone in a cube: within all planes, and outside of each of the convex sets that are left out.
struct BonePart {
  bool nothing = false;
  bool unknown = false;  ///< the bone may be any part of that
  std::vector<CuttingPlane> planes = {};
  std::vector<std::vector<CuttingPlane>> left_out = {};
};

/// The volume in the cube of the bone before all of the planes.
Enclosure bone_within(const Cube& cube, const BonePart& bone, std::span<const CuttingPlane> planes) {
  ClippedCube part(cube.half_width);
  for (const CuttingPlane& plane : bone.planes) part.clip(plane);
  for (const CuttingPlane& plane : planes) part.clip(plane);
  Enclosure volume = part.volume();
  // A single set is left out exactly; for several, the sum and the largest bound the volume that they cover.
  Enclosure covered{0.0, 0.0};
  for (const std::vector<CuttingPlane>& convex : bone.left_out) {
    ClippedCube inside = part;
    for (const CuttingPlane& plane : convex) inside.clip(plane);
    const Enclosure one = inside.volume();
    covered = {std::max(covered.lo, one.lo), verify::add(covered.hi, one.hi, Direction::up)};
  }
  return rest(volume, covered);
}

double cube_volume(const Cube& cube) {
  const double edge = 2.0 * cube.half_width;
  return edge * edge * edge;  // exact: powers of two
}

/// The divisions of cubes.
class CubeTree {
 public:
  /// The first of eight octants, one after the other. Precondition: it has none yet.
  std::uint32_t divide(std::uint32_t place) {
    octants_[place] = static_cast<std::uint32_t>(octants_.size());
    octants_.resize(octants_.size() + 8, 0);
    return octants_[place];
  }

  [[nodiscard]] std::vector<CubeDivision> in_preorder() const {
    std::vector<CubeDivision> cubes;
    cubes.reserve(octants_.size());
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const std::uint32_t first = octants_[open.back()];
      open.pop_back();
      cubes.push_back(first > 0 ? CubeDivision::divided : CubeDivision::none);
      if (first == 0) continue;
      for (std::uint32_t k = 8; k > 0; --k) open.push_back(first + k - 1);
    }
    return cubes;
  }

 private:
  std::vector<std::uint32_t> octants_{0};  // of each cube the first octant; 0: it is not divided
};

class RemovalSearch {
 public:
  RemovalSearch(std::span<const Pose> path, const Model& implant, const BoneRegion& bone,
                const RemovedVolumeOptions& options)
      : options_(options), path_(path), resection_(bone.resection) {
    for (const Primitive& primitive : implant.primitives) primitives_.emplace_back(primitive, path_);
    for (const BoneSurface& surface : bone.surfaces) add(surface);
    verify::require_cavities_in_bone(
        bone, [this](std::size_t n) -> const auto& { return surfaces_[n].closed(); });
  }

  RemovedVolume operator()() {
    RegionCube root = root_cube();
    found_.divided = {.centre = root.cube.centre, .half_width = root.cube.half_width};
    evaluate(root);
    found_.cubes = 1;
    settle_or_open(std::move(root));
    while (true) {
      found_.volume = total();
      options_.progress(found_.volume);
      found_.within_tolerance = is_enough();
      found_.interrupted = options_.interrupted();
      if (found_.within_tolerance || found_.interrupted || found_.cubes >= options_.most_cubes) break;
      if (!divide()) break;
    }
    found_.divided.cubes = tree_.in_preorder();
    return std::move(found_);
  }

 private:
  void add(const BoneSurface& surface) {
    check_surface_has_sides(surface.mesh);
    const verify::Closing closing = verify::closing_over_rims(surface.mesh);
    std::vector<Triangle> triangles = verify::closed_triangles(surface.mesh, closing);
    const std::optional<int> orientation = verify::orientation_of(triangles);
    if (!orientation) throw Error(ErrorKind::input, "removed volume: a surface encloses nothing, closed over its rims");
    const verify::Side side = surface.bone == BoneSide::inside ? verify::Side::inside : verify::Side::outside;
    surfaces_.emplace_back(std::move(triangles), *orientation, side);
    found_.rims.push_back(closing.rims);
  }

  /// Contains all that is swept; its half-width is a power of two.
  [[nodiscard]] RegionCube root_cube() const {
    std::array<Interval, 3> box = primitives_.front().box();
    for (const MovingPrimitive& primitive : primitives_) {
      const std::array<Interval, 3> other = primitive.box();
      for (std::size_t i = 0; i < 3; ++i) box[i] = hull(box[i], other[i]);
    }
    double extent = 0.0;
    double largest = 0.0;
    for (const Interval& side : box) {
      extent = std::max(extent, (side - Interval(side.lower())).upper() / 2.0);
      largest = std::max({largest, std::abs(side.lower()), std::abs(side.upper())});
    }
    // Each centre is off its middle by half a unit of the grid, at most.
    const double half_width = std::exp2(std::ceil(std::log2(extent * 1.001)));
    if (!(half_width > 1e-60 && half_width < 1e60 && largest < 0x1p20 * half_width))
      throw Error(ErrorKind::input, "removed volume: the implant's size, its path or its place leave no exact cubes");
    RegionCube root{.cube = {{}, half_width}};
    const double grid = half_width / centre_bits;
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = 0.5 * box[i].lower() + 0.5 * box[i].upper();
      root.cube.centre[i] = std::round(middle / grid) * grid;
      if (!(root.cube.centre[i] - half_width <= box[i].lower() && root.cube.centre[i] + half_width >= box[i].upper())) {
        root.cube.half_width = 2.0 * half_width;
      }
    }
    for (std::uint32_t k = 0; k < primitives_.size(); ++k) {
      root.primitives.push_back({k, primitives_[k].whole_path()});
    }
    for (const DividedSurface& surface : surfaces_) root.surfaces.push_back(surface.piece(root.cube));
    return root;
  }

  [[nodiscard]] BonePart bone_in(const RegionCube& here) const {
    BonePart bone;
    if (resection_) bone.planes.push_back(verify::plane_in(here.cube, resection_->point, resection_->normal));
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
      CubePart part = surfaces_[n].part(here.cube, here.surfaces[n]);
      switch (part.kind) {
        case CubePart::Kind::nothing: bone.nothing = true; break;
        case CubePart::Kind::all: break;
        case CubePart::Kind::within:
          bone.planes.insert(bone.planes.end(), part.planes.begin(), part.planes.end());
          break;
        case CubePart::Kind::beyond: bone.left_out.push_back(std::move(part.planes)); break;
        case CubePart::Kind::unknown: bone.unknown = true; break;
      }
    }
    return bone;
  }

  /// The swept part of the cube, from its unswept part: that lies before all inner planes, and contains every point
  /// before all outer ones.
  void evaluate(RegionCube& here) const {
    here.removed = {0.0, 0.0};
    const BonePart bone = bone_in(here);
    if (bone.nothing) return;
    bool covered = false;
    bool anything = false;
    bool all_may_be_swept = false;
    std::vector<CuttingPlane> surely_left;
    std::vector<CuttingPlane> maybe_left;
    std::vector<NearPrimitive> near;
    for (const NearPrimitive& candidate : here.primitives) {
      SweptPart part = primitives_[candidate.primitive].part(here.cube, candidate.stretches);
      if (part.open.empty()) continue;
      anything = true;
      covered = covered || part.covered;
      near.push_back({candidate.primitive, std::move(part.open)});
      if (part.inner) maybe_left.push_back(opposite(*part.inner));
      if (part.outer) surely_left.push_back(opposite(*part.outer));
      all_may_be_swept = all_may_be_swept || !part.outer;
    }
    here.primitives = std::move(near);
    if (!anything) return;
    const Enclosure all = bone_within(here.cube, bone, {});
    const double left_lo = covered || all_may_be_swept ? 0.0 : bone_within(here.cube, bone, surely_left).lo;
    const double left_hi = covered ? 0.0 : bone_within(here.cube, bone, maybe_left).hi;
    here.removed = rest(all, {left_lo, left_hi});
    if (bone.unknown) here.removed.lo = 0.0;
  }

  /// A cube whose volume is known to rounding is not divided.
  void settle_or_open(RegionCube&& cube) {
    constexpr double rounding = 0x1p-30;
    if (cube.removed.width() <= rounding * cube_volume(cube.cube) || cube.level == deepest_level) {
      settled_ = sum(settled_, cube.removed);
    } else {
      open_.push_back(std::move(cube));
    }
  }

  [[nodiscard]] Enclosure total() const {
    Enclosure all = settled_;
    for (const RegionCube& cube : open_) all = sum(all, cube.removed);
    return all;
  }

  [[nodiscard]] double allowed() const {
    return std::max(options_.tolerance, options_.relative_tolerance * found_.volume.lo);
  }

  [[nodiscard]] bool is_enough() const { return found_.volume.width() <= allowed(); }

  /// Divides the cubes with the widest volumes: so many that the others' widths are a share of the tolerance, and no
  /// more than the budget allows. False if none is left.
  bool divide() {
    if (open_.empty()) return false;
    std::ranges::sort(open_, {}, [](const RegionCube& cube) { return cube.removed.width(); });
    double rest = share_of_rest * allowed();
    std::size_t kept = 0;
    while (kept + 1 < open_.size() && (rest -= open_[kept].removed.width()) > 0.0) ++kept;
    const std::uint64_t most = (options_.most_cubes - found_.cubes) / 8 + 1;
    if (open_.size() - kept > most) kept = open_.size() - most;
    std::vector<RegionCube> parents(std::make_move_iterator(open_.begin() + static_cast<std::ptrdiff_t>(kept)),
                                    std::make_move_iterator(open_.end()));
    open_.resize(kept);
    for (std::size_t first = 0; first < parents.size(); first += cubes_between_polls) {
      const std::span<RegionCube> rest_of_parents = std::span(parents).subspan(first);
      if (first > 0 && options_.interrupted()) {
        std::ranges::move(rest_of_parents, std::back_inserter(open_));
        break;
      }
      divide(rest_of_parents.first(std::min(cubes_between_polls, rest_of_parents.size())));
    }
    return true;
  }

  void divide(std::span<const RegionCube> parents) {
    std::vector<std::vector<RegionCube>> children(parents.size());
    std::vector<std::uint32_t> octants;
    for (const RegionCube& parent : parents) octants.push_back(tree_.divide(parent.place));
    in_parallel(parents.size(), [&](std::size_t n) { children[n] = parts_of(parents[n], octants[n]); });
    found_.cubes += 8 * parents.size();
    for (auto& siblings : children)
      for (RegionCube& child : siblings) settle_or_open(std::move(child));
  }

  /// `octants` is the place of the first one.
  [[nodiscard]] std::vector<RegionCube> parts_of(const RegionCube& parent, std::uint32_t octants) const {
    std::vector<RegionCube> children;
    const double half_width = parent.cube.half_width / 2.0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      RegionCube child{.cube = {parent.cube.centre, half_width},
                       .level = parent.level + 1,
                       .place = octants + octant,
                       .primitives = parent.primitives};
      for (std::size_t i = 0; i < 3; ++i)
        child.cube.centre[i] += (octant >> i & 1U) != 0 ? half_width : -half_width;  // exact
      for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        child.surfaces.push_back(surfaces_[n].piece(child.cube, parent.surfaces[n]));
      }
      evaluate(child);
      if (child.removed.hi > 0.0) children.push_back(std::move(child));
    }
    return children;
  }

  const RemovedVolumeOptions& options_;
  verify::EnclosedPath path_;
  std::vector<MovingPrimitive> primitives_;
  std::vector<DividedSurface> surfaces_;
  std::optional<Plane> resection_;
  std::vector<RegionCube> open_;
  CubeTree tree_;
  Enclosure settled_{0.0, 0.0};
  RemovedVolume found_{};
};

void check_removal(const Model& implant, const BoneRegion& bone, const RemovedVolumeOptions& options) {
  verify::require_valid(implant);
  if (!is_union_of_convex(implant))
    throw Error(ErrorKind::input, "removed volume: only of unions of convex primitives, without a bend");
  for (const double tolerance : {options.relative_tolerance, options.tolerance}) {
    if (!(tolerance >= 0.0))
      throw Error(ErrorKind::input,
                  fmt::format("removed volume: tolerance {} is not a number of at least 0", tolerance));
  }
  if (!bone.resection) return;
  const auto& [point, normal] = *bone.resection;
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(point, finite) || !std::ranges::all_of(normal, finite) || normal == Point{})
    throw Error(ErrorKind::input,
                "removed volume: the resection's point or normal is not finite, or the normal is zero");
}

}  // namespace

double negligible_volume(const Model& implant) {
  constexpr double share_of_cube = 1e-7;
  const double diameter = 2.0 * bounding_radius(implant);
  return share_of_cube * diameter * diameter * diameter;
}

RemovedVolume removed_volume(std::span<const Pose> path, const Model& implant, const BoneRegion& bone,
                             const RemovedVolumeOptions& options) {
  check_path(path);
  check_removal(implant, bone, options);
  try {
    return RemovalSearch(path, implant, bone, options)();
  } catch (const std::domain_error&) {  // intervals have no infinite numbers
    throw Error(ErrorKind::input, "removed volume: numbers of the implant, the path or the bone overflow");
  }
}

namespace {

/// Share of the width, at each end: times and directions that the checker tries come from elementary functions, which
/// are not the same everywhere.
constexpr double share_to_spare = 0x1p-10;

Enclosure with_a_little_to_spare(const Enclosure& proven) {
  const double spare = share_to_spare * proven.width();
  return {std::max(0.0, verify::subtract(proven.lo, spare, verify::Direction::down)),
          verify::add(proven.hi, spare, verify::Direction::up)};
}

}  // namespace

CertifiedRemovedVolume certified_removed_volume(std::span<const Pose> path, const Model& implant,
                                                const BoneRegion& bone, const RemovedVolume& found,
                                                const CheckOptions& options) {
  const ProvenRemovedVolume proven = RemovedVolumeChecker(implant, path, bone)(found.divided, options);
  (void)verify::intersection(found.volume, proven.volume, [] { return "the removed volume"; });
  return {with_a_little_to_spare(proven.volume), found.divided, proven.interrupted};
}

namespace {

/// One closed or open surface that has two sides.
void check_surface_of_bone(const char* option, const NamedMesh& surface) {
  try {
    check_surface_has_sides(surface.mesh);
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}: {}: mend it by `verisq surface`", option, surface.name, error.what()));
  }
  const std::size_t parts = mesh_topology(surface.mesh).components;
  if (parts > 1) {
    refuse(fmt::format("{}: {} has {} separate surfaces, and only one can be meant", option, surface.name, parts));
  }
}

void check_outer_surface(const char* option, const NamedMesh& surface) {
  check_surface_of_bone(option, surface);
  const std::optional<int> facing = facing_of(surface.mesh);
  if (facing == 1) return;
  if (facing == -1) refuse(fmt::format("{}: {}: its normals point inward, as a cavity's", option, surface.name));
  refuse(fmt::format("{}: {}: encloses nothing, as far as can be proven: no bone lies in it", option, surface.name));
}

std::optional<Plane> scaled_if(const std::optional<Plane>& resection) {
  return resection ? std::optional(scaled(*resection)) : std::nullopt;
}

}  // namespace

BoneRegion bone_around(NamedMesh cavity, std::optional<NamedMesh> outer, const std::optional<Plane>& resection) {
  if (!outer && !resection) {
    refuse(
        "`cavity`: nothing says where the bone around it ends: give `within` with the bone's outer surface, or "
        "`resection`");
  }
  check_surface_of_bone("`cavity`", cavity);
  BoneRegion region{.surfaces = {}, .resection = scaled_if(resection)};
  region.surfaces.push_back({std::move(cavity.mesh), BoneSide::outside});
  if (!outer) return region;
  check_outer_surface("`within`", *outer);
  const verify::ClosedSurface closed(verify::closed_triangles(outer->mesh, verify::closing_over_rims(outer->mesh)));
  region.surfaces.push_back({std::move(outer->mesh), BoneSide::inside});
  try {
    verify::require_cavities_in_bone(
        region, [&](std::size_t) -> const auto& { return closed; });
  } catch (const Error& error) {
    refuse(fmt::format("`within` {}: {}", outer->name, error.what()));
  }
  return region;
}

BoneRegion bone_inside(NamedMesh outer, const std::optional<Plane>& resection) {
  check_outer_surface("`bone`", outer);
  BoneRegion region{.surfaces = {}, .resection = scaled_if(resection)};
  region.surfaces.push_back({std::move(outer.mesh), BoneSide::inside});
  return region;
}

Mesh before_resection(const NamedMesh& mesh, const Plane& resection) {
  Mesh left = cut_off(mesh.mesh, scaled(resection)).mesh;
  if (left.vertices.empty()) refuse(fmt::format("`resection`: all of {} lies beyond it", mesh.name));
  return left;
}

}  // namespace verisq
