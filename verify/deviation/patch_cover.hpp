/// Patches that somebody proposes to cover the surface of a model's primitives, and where each is proven to lie
/// (docs/mathematics.md §20).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "verify/deviation/proven_samples.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/placement/check_steps.hpp"
#include "verisq/deviation_certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// What is proven of the signed distance at a finite point, whatever is claimed.
using ProvenSignedDistance = std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)>;

/// Whether no point of the patch lies on the boundary of the model's solid, by what is proven of a point's distance.
[[nodiscard]] bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance);

/// Whether all of a patch of this primitive's surface lies on that boundary, by a point that need not be near.
[[nodiscard]] bool is_on_boundary(const Patch& patch, std::size_t primitive, const CertifiedPoint& by,
                                  const ProvenSamples& samples, const ProvenSignedDistance& distance);

/// With respect to the boundary of the model's solid.
enum class PatchPlace : std::uint8_t {
  open,  ///< any part of it may be part of the boundary
  on,    ///< all of it is
  off,   ///< nothing of it
};

/// A patch that is not halved any more.
struct PlacedPatch {
  PatchCell cell;
  PatchPlace place;
};

struct CoveredSurface {
  std::vector<PatchedSurface> surfaces;  ///< one a primitive
  std::vector<PlacedPatch> patches;      ///< prepared

  [[nodiscard]] const PatchedSurface& surface_of(const PatchCell& cell) const { return surfaces[cell.primitive]; }
};

/// Follows the halvings, and proves where the patches lie. Nothing where they are not proven to cover the surfaces of
/// all primitives that count (all where `counted` is empty).
[[nodiscard]] std::optional<CoveredSurface> covered_surface(const SurfaceCover& cover, const std::vector<bool>& counted,
                                                            const ProvenSamples& samples,
                                                            const ProvenSignedDistance& distance, CheckSteps& steps);

/// How many parts `covered_surface` goes through, at most.
[[nodiscard]] std::size_t parts_of(const SurfaceCover& cover);

}  // namespace verisq::verify
