/// How far the surface of a model lies from triangles, proven by patches that somebody proposes (docs/mathematics.md
/// §20).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "verify/deviation/patch_cover.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/deviation/weighted_cells.hpp"
#include "verify/placement/check_steps.hpp"
#include "verisq/deviation_certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// What a proof says of the distance of the solid's boundary from triangles.
struct ProvenSurface {
  Enclosure largest{0.0, infinity};  ///< by patches no closer than `within`; from below alone where one is missing
  AreaStatistics statistics = {};    ///< as far as patches say where they lie; of fewer percentiles, or none
};

/// Mean and percentiles as `options` ask for them. Precondition: at least one triangle, finite.
[[nodiscard]] ProvenSurface proven_surface(const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                                           const DeviationChecker::Options& options, const ProvenSamples& samples,
                                           const ProvenSignedDistance& distance, CheckSteps& steps);

/// The distances of what of each patch lies on the boundary, by area, no larger than `largest`. Nothing where numbers
/// leave binary64, or no patch may lie there.
[[nodiscard]] std::optional<std::vector<WeightedCell>> boundary_cells(const CoveredSurface& surface,
                                                                      const TriangleTree& tree, double largest,
                                                                      CheckSteps& steps);

/// How many parts `proven_surface` goes through, at most.
[[nodiscard]] std::size_t parts_of(const SurfaceProof& proof);

}  // namespace verisq::verify
