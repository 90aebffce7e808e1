/// The lower end is that of all triangles, most by their vertices; the upper end that of a vertex, or of one point.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "verify/analysis/finite_point.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/placement/path_check.hpp"
#include "verify/placement/quartered_triangle.hpp"
#include "verify/placement/surface_of_vertices.hpp"
#include "verify/placement/way_part.hpp"
#include "verify/placement/way_triangle_proof.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verify/proof/triangle_certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/way_surface_certificate.hpp"

namespace verisq {

using verify::Direction;
using verify::PointBall;
using verify::RigidPath;

namespace {

/// Between which progress is told.
constexpr std::size_t triangles_at_a_time = 64;

const Model& required_union(const Model& model) {
  verify::require_union_of_convex(model, "certificates of whole surfaces along a way in");
  return model;
}

/// Each once, and in their order; and not too many cells.
bool is_in_order(const std::vector<WayTriangle>& proofs, std::size_t triangles) {
  std::size_t next = 0;
  std::size_t cells = 0;
  for (const WayTriangle& proof : proofs) {
    if (proof.triangle < next || proof.triangle >= triangles) return false;
    next = std::size_t{proof.triangle} + 1;
    if (proof.cells.size() > most_cells_of_way_surface - cells) return false;
    cells += proof.cells.size();
  }
  return true;
}

}  // namespace

struct WaySurfaceChecker::State {
  State(const Model& model, std::span<const Pose> poses, const Mesh& mesh)
      : bone(mesh),
        implant(required_union(model)),
        solids(verify::solids_of(model)),
        path(poses, verify::seat_of(model, poses)) {}

  /// What the vertices say of each triangle.
  [[nodiscard]] std::vector<double> least_by_vertices(std::span<const Enclosure> of_vertices) const {
    std::vector<double> least(bone.triangles.size());
    for (std::size_t n = 0; n < least.size(); ++n)
      least[n] = verify::least_on(verify::triangle_of(bone, n), verify::lower_ends(bone, n, of_vertices));
    return least;
  }

  [[nodiscard]] double lower(std::span<const Enclosure> of_vertices, const WaySurfaceCertificate& certificate,
                             const CheckOptions& options) const {
    const std::vector<WayTriangle>& proofs = certificate.triangles;
    if (!is_in_order(proofs, bone.triangles.size())) return -infinity;
    std::vector<double> least = least_by_vertices(of_vertices);
    std::atomic<bool> is_whole{true};
    for (std::size_t first = 0; first < proofs.size() && is_whole; first += triangles_at_a_time) {
      const std::size_t now = std::min(triangles_at_a_time, proofs.size() - first);
      options.in_parallel(now, [&](std::size_t i) {
        const WayTriangle& proof = proofs[first + i];
        const std::size_t n = proof.triangle;
        if (options.interrupted()) {
          is_whole = false;
        } else {
          const auto at_vertices = verify::lower_ends(bone, n, of_vertices);
          least[n] =
              std::max(least[n], verify::least_on(path, solids, verify::triangle_of(bone, n), at_vertices, proof));
        }
      });
      options.progress(static_cast<double>(first + now) / static_cast<double>(proofs.size()));
    }
    return is_whole ? std::ranges::min(least) : -infinity;
  }

  [[nodiscard]] double upper_by(const WayWitness& witness, double asked) const {
    const auto& [triangle, weights, time, certificate] = witness;
    if (triangle >= bone.triangles.size() || !verify::in_triangle(weights)) return infinity;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    const auto& [a, b, c] = verify::triangle_of(bone, triangle);
    const verify::PreciseVector exact =
        verify::point_of({verify::precise(a), verify::precise(b), verify::precise(c)}, weights);
    const verify::Proposal middle = verify::midpoint(exact);
    const Point near{static_cast<double>(middle[0]), static_cast<double>(middle[1]), static_cast<double>(middle[2])};
    if (!verify::is_finite(near)) return infinity;
    // Motions keep distances: the exact point is seen no farther from the near one than it is.
    const double off = verify::length<verify::Real>(verify::PreciseVector(exact - verify::precise(near)))
                           .upper()
                           .to_double(Direction::up);
    PointBall place = verify::moment_of(path, near, time).place;
    place.radius = verify::add(place.radius, off, Direction::up);
    return verify::upper_end(implant, place, asked, certificate);
  }

  [[nodiscard]] double upper(std::span<const Enclosure> of_vertices, double asked,
                             const WaySurfaceCertificate& certificate) const {
    const double by_vertices = verify::least_upper_end(bone, of_vertices);
    return certificate.deepest ? std::min(by_vertices, upper_by(*certificate.deepest, asked)) : by_vertices;
  }

  const Mesh& bone;
  Checker implant;
  std::vector<verify::PosedSuperquadric> solids;
  RigidPath path;
};

WaySurfaceChecker::WaySurfaceChecker(const Model& implant, std::span<const Pose> path, const Mesh& bone) {
  check_path(path);
  if (bone.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  state_ = std::make_unique<State>(implant, path, bone);
}
WaySurfaceChecker::~WaySurfaceChecker() = default;
WaySurfaceChecker::WaySurfaceChecker(WaySurfaceChecker&&) noexcept = default;
WaySurfaceChecker& WaySurfaceChecker::operator=(WaySurfaceChecker&&) noexcept = default;

Finding WaySurfaceChecker::operator()(std::span<const Enclosure> of_vertices, const Enclosure& claimed,
                                      const WaySurfaceCertificate& certificate, const CheckOptions& options) const {
  const Enclosure proven = verify::between(state_->lower(of_vertices, certificate, options),
                                           state_->upper(of_vertices, claimed.hi, certificate),
                                           [] { return "the smallest distance of the whole surface on the way"; });
  return verify::judged(claimed, proven, proven);
}

}  // namespace verisq
