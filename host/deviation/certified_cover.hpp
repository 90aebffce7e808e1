/// Patches of a model's surface, halved until their areas and distances say enough, with what proves where they lie.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "host/deviation/certified_place.hpp"
#include "host/threads/seen_interruption.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/deviation/weighted_cells.hpp"
#include "verisq/deviation_certificate.hpp"
#include "verisq/model.hpp"

namespace verisq {

/// Marks which of the cells have to be smaller; none where they say enough.
using CoverGoal = std::function<void(std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen)>;

/// What it refers to must outlive it.
struct CoverRequest {
  const Model& model;
  const verify::TriangleTree& triangles;
  const PatchPlacer& placer;
  std::vector<bool> counted;  ///< as `ContactTerms`
  double largest;             ///< no point of the boundary is farther from the triangles
  CoverGoal choose;
  std::size_t bytes;  ///< of a file, about
  const SeenInterruption& interrupted;
};

/// Halves the patches of a cover further, until the goal is reached, or the file would be too large; says where they
/// lie. Precondition: it covers the primitives that count.
[[nodiscard]] SurfaceCover certified_cover(const CoverRequest& request, SurfaceCover begun);

/// The octants of the primitives that count.
[[nodiscard]] SurfaceCover octants_of(const Model& model, const std::vector<bool>& counted);

}  // namespace verisq
