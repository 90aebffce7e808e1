/// Follows the parts of the cube in the order of the certificate. Each undivided part's volume is enclosed by itself,
/// and the sums are rounded outward.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/check_steps.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/volume_in_cube.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"
#include "verisq/insertion.hpp"

namespace verisq {

using verify::BoundingSurface;
using verify::BracketedPart;
using verify::Cube;
using verify::Direction;
using verify::PartOfLeg;
using verify::SweptPrimitive;

namespace {

/// Binary64 has no more halvings than that of a width whose cube it has, too.
constexpr std::size_t deepest_division = 64;
/// At least this number of cubes is to be shared by threads, or about as many cubes as there are.
constexpr std::size_t enough_for_all_threads = 512;

Enclosure sum_of(const Enclosure& a, const Enclosure& b) {
  return {verify::add(a.lo, b.lo, Direction::down), verify::add(a.hi, b.hi, Direction::up)};
}

/// A primitive that may sweep a part of a cube, and when.
struct SweepingPrimitive {
  std::uint32_t primitive;
  std::vector<PartOfLeg> times;
};
using SweepingPrimitives = std::vector<SweepingPrimitive>;

/// A cube of the certificate, and the parts of the case that matter there.
struct CubeInCase {
  Cube cube;
  std::size_t index = 0;                                      ///< in the certificate
  std::shared_ptr<const SweepingPrimitives> primitives = {};  ///< no other primitives sweep any of the cube, nor do
                                                              ///< these at other times
  std::vector<BoundingSurface::Piece> surfaces = {};
};

/// The one of the eight; nothing where binary64 does not hold it exactly.
std::optional<Cube> octant_of(const Cube& cube, unsigned octant) {
  Cube result{cube.centre, 0.5 * cube.half_width};
  if (!(result.half_width > 0.0) || 2.0 * result.half_width != cube.half_width) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    const double by = (octant >> i & 1U) != 0 ? result.half_width : -result.half_width;
    const double down = verify::add(cube.centre[i], by, Direction::down);
    if (down != verify::add(cube.centre[i], by, Direction::up)) return std::nullopt;
    result.centre[i] = down;
  }
  return result;
}

/// A certificate's cubes.
class Division {
 public:
  /// Nothing unless `cubes` are the parts of one cube.
  static std::optional<Division> of(std::span<const CubeDivision> cubes) {
    struct Open {
      std::size_t index;
      unsigned missing;  // of its octants
    };
    if (cubes.empty() || cubes.size() > most_cubes_of_certificate) return std::nullopt;
    Division division(cubes);
    std::vector<Open> open;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      if (i > 0 && open.empty()) return std::nullopt;
      if (division.is_divided(i)) {
        if (open.size() == deepest_division) return std::nullopt;
        open.push_back({i, 8});
        continue;
      }
      division.ends_[i] = static_cast<std::uint32_t>(i + 1);
      while (!open.empty() && --open.back().missing == 0) {
        division.ends_[open.back().index] = static_cast<std::uint32_t>(i + 1);
        open.pop_back();
      }
    }
    if (!open.empty()) return std::nullopt;
    return division;
  }

  [[nodiscard]] bool is_divided(std::size_t index) const { return cubes_[index] == CubeDivision::divided; }

  /// The index at which the next cube begins that is no part of this one.
  [[nodiscard]] std::size_t end(std::size_t index) const { return ends_[index]; }

 private:
  explicit Division(std::span<const CubeDivision> cubes) : cubes_(cubes), ends_(cubes.size()) {}

  std::span<const CubeDivision> cubes_;
  std::vector<std::uint32_t> ends_;
};

void check_removed_volume_case(const Model& implant, std::span<const Pose> path, const BoneRegion& bone) {
  verify::require_union_of_convex(implant, "removed volume");
  check_path(path);
  if (!bone.resection) return;
  const auto& [point, normal] = *bone.resection;
  if (!verify::is_finite(point) || !verify::is_finite(normal) || normal == Point{})
    throw Error(ErrorKind::input,
                "removed volume: the resection's point or normal is not finite, or the normal is zero");
}

}  // namespace

struct RemovedVolumeChecker::State {
  State(const Model& implant, std::span<const Pose> poses, const BoneRegion& bone)
      : path(poses), resection(bone.resection) {
    for (const Primitive& primitive : implant.primitives) primitives.emplace_back(primitive, path);
    for (const BoneSurface& surface : bone.surfaces) {
      surfaces.emplace_back(surface);
      rims.push_back(surfaces.back().rims());
    }
    verify::require_cavities_in_bone(
        bone, [this](std::size_t n) -> const auto& { return surfaces[n].closed(); });
  }

  /// Returns whether all swept points lie in the cube.
  [[nodiscard]] bool holds_all(const Cube& cube) const {
    return std::ranges::all_of(primitives, [&](const SweptPrimitive& primitive) {
      const auto box = primitive.box();
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(box[i].lower() >= verify::subtract(cube.centre[i], cube.half_width, Direction::up))) return false;
        if (!(box[i].upper() <= verify::add(cube.centre[i], cube.half_width, Direction::down))) return false;
      }
      return true;
    });
  }

  [[nodiscard]] CubeInCase whole(const Cube& cube) const {
    SweepingPrimitives all;
    for (std::uint32_t k = 0; k < primitives.size(); ++k) all.push_back({k, primitives[k].whole_path()});
    CubeInCase root{.cube = cube, .primitives = std::make_shared<const SweepingPrimitives>(std::move(all))};
    for (const BoundingSurface& surface : surfaces) root.surfaces.push_back(surface.piece(cube));
    return root;
  }

  /// The octants of a cube in which bone may be removed. Nothing if the cube is not divided, or not into octants that
  /// binary64 can represent.
  [[nodiscard]] std::optional<std::vector<CubeInCase>> octants(const CubeInCase& of, const Division& division,
                                                               const std::function<bool()>& interrupted) const {
    if (!division.is_divided(of.index)) return std::nullopt;
    std::vector<CubeInCase> result;
    const std::shared_ptr<const SweepingPrimitives> sweeping = narrowed(of, interrupted);
    std::size_t index = of.index + 1;
    for (unsigned octant = 0; octant < 8; ++octant) {
      const std::optional<Cube> cube = octant_of(of.cube, octant);
      if (!cube) return std::nullopt;
      CubeInCase part{.cube = *cube, .index = index, .primitives = sweeping};
      index = division.end(index);
      bool nothing = sweeping->empty();
      for (std::size_t n = 0; n < surfaces.size() && !nothing; ++n) {
        part.surfaces.push_back(piece_of(surfaces[n], *cube, of.surfaces[n]));
        nothing = surfaces[n].leaves_nothing(part.surfaces.back());
      }
      if (!nothing) result.push_back(std::move(part));
    }
    return result;
  }

  /// The volume removed from the bone in a cube.
  [[nodiscard]] Enclosure removed_in(const CubeInCase& here, const std::function<bool()>& interrupted) const try {
    const Cube& cube = here.cube;
    BracketedPart part;
    if (resection) part = before(*resection, cube);
    for (std::size_t n = 0; n < surfaces.size(); ++n) surfaces[n].restrict(part, cube, here.surfaces[n]);
    const bool known = std::ranges::none_of(part.inner, [](const auto& whole) { return whole.empty(); });
    verify::UnionOfParts inner;
    verify::UnionOfParts outer;
    for (const auto& [k, times] : *here.primitives) {
      const SweptPrimitive::InCube found = primitives[k].in(cube, times, interrupted);
      if (found.times.empty()) continue;
      outer.push_back(found.outer);
      if (known) inner.push_back(primitives[k].inner(cube, found.deepest));
    }
    if (outer.empty()) return {0.0, 0.0};
    part.inner.push_back(std::move(inner));
    part.outer.push_back(std::move(outer));
    return verify::volume_in_cube(cube.half_width, part);
  } catch (const std::domain_error&) {  // what no interval holds
    return {0.0, verify::volume_of_cube(here.cube.half_width).upper()};
  }

  /// The cube and its largest parts, until there are enough of them to be shared.
  [[nodiscard]] std::vector<CubeInCase> large_parts(const Cube& cube, const Division& division,
                                                    const std::function<bool()>& interrupted) const {
    std::vector<CubeInCase> parts{whole(cube)};
    for (bool all_undivided = false; !all_undivided && parts.size() < enough_for_all_threads && !interrupted();) {
      all_undivided = true;
      std::vector<CubeInCase> smaller;
      for (CubeInCase& part : parts) {
        auto divided = octants(part, division, interrupted);
        all_undivided = all_undivided && !divided;
        if (divided) {
          std::ranges::move(*divided, std::back_inserter(smaller));
        } else {
          smaller.push_back(std::move(part));
        }
      }
      parts = std::move(smaller);
    }
    return parts;
  }

  /// In a cube and all of its parts. Once interrupted it is less than there is.
  [[nodiscard]] Enclosure removed_below(CubeInCase start, const Division& division,
                                        const std::function<bool()>& interrupted) const {
    Enclosure sum{0.0, 0.0};
    std::vector<CubeInCase> open{std::move(start)};
    while (!open.empty() && !interrupted()) {
      const CubeInCase here = std::move(open.back());
      open.pop_back();
      if (auto parts = octants(here, division, interrupted)) {
        std::ranges::move(*parts, std::back_inserter(open));
      } else {
        sum = sum_of(sum, removed_in(here, interrupted));
      }
    }
    return sum;
  }

  verify::EnclosedPath path;
  std::vector<SweptPrimitive> primitives;
  std::vector<BoundingSurface> surfaces;
  std::vector<std::size_t> rims;
  std::optional<Plane> resection;

 private:
  [[nodiscard]] static BracketedPart before(const Plane& plane, const Cube& cube) {
    const verify::UnionOfParts half_space{verify::heights_above(cube, plane.point, verify::exact_vector(plane.normal))};
    return {{half_space}, {half_space}};
  }

  /// Where numbers overflow nothing more is known than of the larger cube.
  [[nodiscard]] static BoundingSurface::Piece piece_of(const BoundingSurface& surface, const Cube& cube,
                                                       const BoundingSurface::Piece& whole) try {
    return surface.piece(cube, whole);
  } catch (const std::domain_error&) {
    return {.triangles = whole.triangles};
  }

  /// The primitives that may sweep a part of this cube.
  [[nodiscard]] std::shared_ptr<const SweepingPrimitives> narrowed(const CubeInCase& here,
                                                                   const std::function<bool()>& interrupted) const try {
    SweepingPrimitives result;
    for (const auto& [k, times] : *here.primitives) {
      SweptPrimitive::InCube found = primitives[k].in(here.cube, times, interrupted);
      if (!found.times.empty()) result.push_back({k, std::move(found.times)});
    }
    return std::make_shared<const SweepingPrimitives>(std::move(result));
  } catch (const std::domain_error&) {
    return here.primitives;
  }
};

RemovedVolumeChecker::RemovedVolumeChecker(const Model& implant, std::span<const Pose> path, const BoneRegion& bone) {
  check_removed_volume_case(implant, path, bone);
  try {
    state_ = hidden<State>(implant, path, bone);
  } catch (const std::domain_error&) {
    throw Error(ErrorKind::input, "removed volume: numbers of the implant, the path or the bone overflow");
  }
}

const std::vector<std::size_t>& RemovedVolumeChecker::rims() const {
  return state_->rims;
}

ProvenRemovedVolume RemovedVolumeChecker::operator()(const RemovedVolumeCertificate& certificate,
                                                     const CheckOptions& options) const try {
  const std::optional<Division> division = Division::of(certificate.cubes);
  const Cube cube{certificate.centre, certificate.half_width};
  if (!division || !verify::is_finite(cube.centre) || !std::isfinite(cube.half_width) || !(cube.half_width > 0.0)) {
    return {};
  }
  const std::vector<CubeInCase> parts = state_->large_parts(cube, *division, options.interrupted);
  std::vector<Enclosure> volumes(parts.size(), Enclosure{0.0, 0.0});
  verify::CheckSteps steps(parts.size(), options);
  steps.each(parts.size(),
             [&](std::size_t i) { volumes[i] = state_->removed_below(parts[i], *division, options.interrupted); });
  if (options.interrupted()) return {.interrupted = true};
  ProvenRemovedVolume result{.volume = {0.0, 0.0}, .cubes = certificate.cubes.size()};
  for (const Enclosure& volume : volumes) result.volume = sum_of(result.volume, volume);
  if (!state_->holds_all(cube)) result.volume.hi = infinity;
  return result;
} catch (const std::domain_error&) {  // what no interval holds
  return {};
}

}  // namespace verisq
