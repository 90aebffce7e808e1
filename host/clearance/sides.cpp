/// Asks the checker for each primitive.
#include "verisq/sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/threads/parallel.hpp"
#include "verify/containment/orientation.hpp"
#include "verify/containment/rims.hpp"
#include "verify/sets/set_tree.hpp"
#include "verify/sides/oriented_surface.hpp"
#include "verisq/error.hpp"

namespace verisq {

std::vector<std::uint32_t> covering_primitives(const Model& model) {
  return verify::covering_primitives(model);
}

bool Sides::kept() const {
  return std::ranges::all_of(of_primitives, [](SideFinding finding) { return finding == SideFinding::kept; });
}

std::vector<SideClaim> claims_of(const Sides& sides, std::span<const SurfaceSide> required) {
  std::vector<SideClaim> claims;
  for (std::size_t k = 0; k < required.size(); ++k) {
    if (required[k] != SurfaceSide::any && sides.of_primitives[k] == SideFinding::kept)
      claims.push_back({k, required[k]});
  }
  return claims;
}

bool faces_outward(const Mesh& surface) {
  const auto triangles = verify::closed_triangles(surface, verify::closing_over_rims(surface));
  return verify::orientation_of(triangles) == 1;
}

void check_surface_has_sides(const Mesh& surface) {
  verify::require_sides(surface);
}

Sides prove_sides(const Model& model, const Mesh& surface, std::span<const SurfaceSide> required,
                  double penetration_limit, const std::function<bool()>& interrupted) {
  if (required.size() != model.primitives.size()) {
    throw Error(ErrorKind::input,
                fmt::format("sides: {} required of {} primitives", required.size(), model.primitives.size()));
  }
  const SideChecker checker(model, surface, penetration_limit);
  Sides sides{.of_primitives = {}, .rims = checker.rims()};
  for (std::size_t k = 0; k < required.size(); ++k) {
    sides.of_primitives.push_back(checker(
        {k, required[k]}, {.in_parallel = in_parallel<std::function<void(std::size_t)>>, .interrupted = interrupted}));
  }
  return sides;
}

}  // namespace verisq
