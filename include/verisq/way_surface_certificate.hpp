/// Proves the smallest signed distance of a bone's whole surface to an implant on its way in again: MPFR, no OpenCL, no
/// search.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What becomes of a piece of a triangle on a part of the way. At first the piece is the triangle, the part all of the
/// way.
enum class WayCell : std::uint8_t {
  by_vertices,  ///< the proven distances of the triangle's vertices, which change by no more than the place, suffice
  moved,        ///< moved out of the implant, the piece is clear of it all the while
  quartered,    ///< the piece is divided at the middles of its sides: at each corner one, then the middle one
  halved,       ///< the part is divided: first the earlier half
};

/// No piece is quartered more often.
inline constexpr int most_quarterings = 20;

/// More cells than that, in all triangles together, prove nothing: what would take longer to follow no checker need
/// have.
inline constexpr std::size_t most_cells_of_way_surface = std::size_t{1} << 21U;

/// What the piece sweeps on the part of the way, as the resting implant sees it, lies within a bulge of the convex hull
/// of where its corners begin and end. That hull, moved by `step`, is outside of each primitive, beyond a half-space of
/// one of its `normals`, or of one that the checker tries where it has none here. Then nothing in the cell is deeper
/// inside than the step is long, but for the bulge (docs/mathematics.md §16).
struct MovedCell {
  Point step;  ///< in the implant's frame
  std::vector<Normal> normals;

  [[nodiscard]] bool operator==(const MovedCell&) const = default;
};

/// How one triangle is divided.
struct WayTriangle {
  std::uint32_t triangle = 0;
  std::vector<WayCell> cells;    ///< in preorder
  std::vector<MovedCell> moved;  ///< one for each cell that is moved, in their order

  [[nodiscard]] bool operator==(const WayTriangle&) const = default;
};

/// A point of the surface at a time.
struct WayWitness {
  std::uint32_t triangle = 0;
  std::array<double, 2> weights{};  ///< as of `Certificate`
  double time = 0.0;
  Certificate certificate;  ///< of the point where the resting implant sees it

  [[nodiscard]] bool operator==(const WayWitness&) const = default;
};

/// What proves an enclosure [lo, hi] of the smallest signed distance of all points of all triangles along the way,
/// beside what is proven of their vertices, whatever it holds.
struct WaySurfaceCertificate {
  std::optional<WayWitness> deepest;   ///< its distance is at most hi; none where a vertex is as deep
  std::vector<WayTriangle> triangles;  ///< in the order of the mesh; of all others the vertices suffice

  [[nodiscard]] bool operator==(const WaySurfaceCertificate&) const = default;
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Immutable after construction: safe to call from many threads.
class WaySurfaceChecker {
 public:
  /// Throws Error(input) for another model, for a mesh without triangles, and for a path as InsertionChecker. `bone`
  /// has to outlive this.
  WaySurfaceChecker(const Model& implant, std::span<const Pose> path, const Mesh& bone);
  ~WaySurfaceChecker();
  WaySurfaceChecker(WaySurfaceChecker&&) noexcept;
  WaySurfaceChecker& operator=(WaySurfaceChecker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the smallest signed distance, whatever the certificate
  /// holds, if `of_vertices` are proven: enclosures of the smallest signed distance of each vertex along the way.
  /// Interrupted, it has proven nothing from below. Precondition: one for each vertex, and no NaN.
  [[nodiscard]] Finding operator()(std::span<const Enclosure> of_vertices, const Enclosure& claimed,
                                   const WaySurfaceCertificate& certificate, const CheckOptions& options = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
