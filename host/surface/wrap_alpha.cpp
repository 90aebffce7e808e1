/// Wraps of falling alpha, until one breaks through.
#include "host/surface/wrap_alpha.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/mesh/extent.hpp"
#include "host/surface/alpha_wrap.hpp"

namespace verisq::surface {
namespace {

constexpr double coarsest = 20.0;  ///< diagonal / alpha: bridges the gaps of any cloud worth the name
constexpr int most_refinements = 4;
constexpr double offset_ratio = 100.0;  ///< alpha / offset

/// Balls that get in through a gap carve the inside out: what is left is a shell around the input.
bool breaks_through(const Mesh& finer, const Mesh& coarser) {
  constexpr double least_volume_kept = 0.85;
  const MeshTopology fine = mesh_topology(finer);
  const MeshTopology coarse = mesh_topology(coarser);
  return signed_volume(finer) < least_volume_kept * signed_volume(coarser) || fine.components > coarse.components ||
         fine.genus() > coarse.genus();
}

}  // namespace

Wrap wrap(const Mesh& input, double alpha, std::optional<double> offset) {
  const double kept = offset.value_or(alpha / offset_ratio);
  return {alpha_wrap(input, alpha, kept), alpha, kept};
}

Wrap wrap_with_chosen_alpha(const Mesh& input, std::optional<double> offset) {
  const double diagonal = 2.0 * extent_of(input.vertices).half_diagonal();
  if (!(diagonal > 0.0)) throw Error(ErrorKind::input, "all points coincide: there is nothing to wrap");
  Wrap best = wrap(input, diagonal / coarsest, offset);
  for (int k = 0; k < most_refinements; ++k) {
    Wrap finer = wrap(input, best.alpha / std::sqrt(2.0), offset);
    if (breaks_through(finer.mesh, best.mesh)) break;
    best = std::move(finer);
  }
  return best;
}

}  // namespace verisq::surface
