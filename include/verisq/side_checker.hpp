/// Proves again on which side of a surface the parts of an implant lie, from model and mesh alone: MPFR, no OpenCL, no
/// search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/surface_side.hpp>

namespace verisq {

/// That every point of a primitive, whole, which lies deeper in it than the limit of penetration is on that side.
struct SideClaim {
  std::size_t primitive;  ///< an index
  SurfaceSide side;       ///< any is always kept
};

enum class SideFinding : std::uint8_t {
  kept,             ///< proven: see SideChecker
  other_side,       ///< proven to be broken: the centre lies deeper than the limit, and is not on that side
  enters_surface,   ///< it is not proven to keep off the surface, so that it may reach through
  reaches_through,  ///< it is not proven to keep off the openings
  no_deep_point,    ///< it has no point that is known to lie deeper than the limit of penetration
  on_the_surface,   ///< rounding leaves its point's side open
  strongly_bent,    ///< its points deeper than the limit of penetration are not known to be connected
  several_parts,    ///< the surface is in several parts, and nobody says of which that is the side
  no_volume,        ///< it is not proven that the surface, closed over its rims, encloses anything
};

/// "proven", "other side", "not off the surface", "not off the openings", "centre not deep enough", "centre not
/// decided", "bend too strong for the limit", "surface in several parts",
/// "surface encloses nothing".
[[nodiscard]] constexpr std::string_view to_string(SideFinding finding) {
  switch (finding) {
    case SideFinding::kept: return "proven";
    case SideFinding::other_side: return "other side";
    case SideFinding::enters_surface: return "not off the surface";
    case SideFinding::reaches_through: return "not off the openings";
    case SideFinding::no_deep_point: return "centre not deep enough";
    case SideFinding::on_the_surface: return "centre not decided";
    case SideFinding::strongly_bent: return "bend too strong for the limit";
    case SideFinding::several_parts: return "surface in several parts";
    case SideFinding::no_volume: break;
  }
  return "surface encloses nothing";
}

/// `proved` where it is kept, `refuted` where the other side is, else `unproved`.
[[nodiscard]] Verdict verdict_of(SideFinding finding);

/// Immutable after construction: safe to call from many threads.
class SideChecker {
 public:
  /// Of any model, each of whose primitives is asked for on its own. Precondition: triangles of vertices that are
  /// there, finite coordinates. Throws Error(input) for a mesh without sides, as `check_surface_has_sides`, a limit
  /// that is not finite and at least 0, and models that are none.
  SideChecker(const Model& model, const Mesh& surface, double penetration_limit);
  ~SideChecker();
  SideChecker(SideChecker&&) noexcept;
  SideChecker& operator=(SideChecker&&) noexcept;

  /// Kept: no point of the surface, nor of the fans that close it over its rims, lies deeper in the primitive than the
  /// limit; those points that do are connected, the centre among them, which is on that side: hence all of them are
  /// (docs/mathematics.md §22). Inside is where the closed surface winds about a point as it does about its volume,
  /// outside where it does not wind. Of a surface in several parts, as of one whose triangles do not share their
  /// vertices, nothing is kept, nor of one that encloses nothing, nor once interrupted. Precondition: a primitive that
  /// there is.
  [[nodiscard]] SideFinding operator()(const SideClaim& claim, const CheckOptions& options = {}) const;

  /// Whether the closed surface's normals point outward, as a bone's; nothing where that is not proven.
  [[nodiscard]] std::optional<bool> faces_outward() const;

  /// Over which the surface is closed, by fans about their means.
  [[nodiscard]] std::size_t rims() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
