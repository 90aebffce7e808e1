/// How far the surface of a model lies from triangles, proven by patches that somebody proposes (docs/mathematics.md
/// §20).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/placement/check_steps.hpp"
#include "verisq/deviation_certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// What is proven of the signed distance at a finite point, whatever is claimed.
using ProvenSignedDistance = std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)>;

/// Whether no point of the patch lies on the boundary of the model's solid, by what is proven of a point's distance.
[[nodiscard]] bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance);

/// Encloses the largest distance of the solid's boundary from the triangles, by patches no closer than `proof.within`.
/// Of a proof that is cut short nothing follows from above. Precondition: at least one triangle, finite.
[[nodiscard]] Enclosure farthest_of_surface(const Model& model, const std::vector<Triangle>& triangles,
                                            const SurfaceProof& proof, const ProvenSignedDistance& distance,
                                            CheckSteps& steps);

/// How many parts `farthest_of_surface` goes through, at most.
[[nodiscard]] std::size_t parts_of(const SurfaceProof& proof);

}  // namespace verisq::verify
