/// The distance of any two models, and its certificate: by the search that serves them.
#include <algorithm>
#include <mutex>
#include <optional>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "verify/search/mesh_union.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

CertifiedDistance PairSearch::certified(const Pose& pose, const SearchedDistance& found,
                                        const SearchOptions& options) const {
  CertifiedDistance result{found.distance, certificate_of(a_, b_, pose, found, options)};
  const Enclosure proven = PairChecker(a_.model, b_.model).prove(pose, result.certificate, options.interrupted);
  result.distance = {std::min(found.distance.lo, proven.lo), std::max(found.distance.hi, proven.hi)};
  return result;
}

}  // namespace verisq::verify

namespace verisq {

namespace {

/// For models of superquadrics. All lengths are in units of a length.
struct ScaledSearch {
  ScaledSearch(const Model& first, const Model& second)
      : a(first),
        b(second),
        unit(verify::unit_of(a, b)),
        search(verify::in_units(a, unit), verify::in_units(b, unit)) {}

  /// Nothing if scaling changes the point, so that the proof does not apply to it.
  [[nodiscard]] std::optional<Point> in_lengths(const Point& x) const { return verify::in_units(x, 1.0 / unit); }

  Model a;
  Model b;
  double unit;  ///< a power of two
  verify::PairSearch search;
};

/// For models with meshes.
struct MeshPairSearch {
  MeshPairSearch(const Model& first, const Model& second) : a(first), b(second), search(first, second) {}

  /// The checker finds the near triangles itself: only a common point has to be named.
  [[nodiscard]] CertifiedDistance certified(const Pose& pose, const SearchedDistance& found,
                                            const SearchOptions& options) const {
    std::call_once(is_made, [this] { checker.emplace(a, b); });
    CertifiedDistance result{found.distance, {.common = found.common}};
    const Enclosure proven = checker->prove(pose, result.certificate, options.interrupted);
    result.distance = {std::min(found.distance.lo, proven.lo), std::max(found.distance.hi, proven.hi)};
    return result;
  }

  Model a;
  Model b;
  verify::MeshPairDistance search;
  mutable std::once_flag is_made;
  mutable std::optional<PairChecker> checker;  ///< made for the first certificate
};

}  // namespace

/// One of the two.
struct ModelSearch::State {
  State(const Model& a, const Model& b) {
    if (has_mesh(a) || has_mesh(b))
      meshes.emplace(a, b);
    else
      superquadrics.emplace(a, b);
  }

  std::optional<ScaledSearch> superquadrics;
  std::optional<MeshPairSearch> meshes;
};

ModelSearch::ModelSearch(const Model& a, const Model& b) {
  for (const Model* const model : {&a, &b}) verify::require_valid_with_meshes(*model);
  state_ = hidden<State>(a, b);
}

SearchedDistance ModelSearch::operator()(const Pose& pose, const SearchOptions& options) const {
  verify::require_valid(pose, "pose");
  verify::require_tolerance(options.tolerance);
  if (state_->meshes) return state_->meshes->search.searched(pose, options);
  const ScaledSearch& state = *state_->superquadrics;
  if (state.unit == 1.0) return state.search(pose, options);
  const std::optional<Pose> in_units = verify::in_units(pose, state.unit);
  if (!in_units) return verify::PairSearch(state.a, state.b)(pose, options);
  SearchOptions scaled = options;
  scaled.tolerance = verify::tolerance_in_units(options.tolerance, state.unit);
  if (options.progress) {
    scaled.progress = [&](const Enclosure& e, std::uint64_t cubes) {
      options.progress(verify::in_lengths(e, state.unit), cubes);
    };
  }
  SearchedDistance found = state.search(*in_units, scaled);
  found.distance = verify::in_lengths(found.distance, state.unit);
  if (found.common) found.common = state.in_lengths(*found.common);
  if (found.near_points) {
    const std::optional<Point> on_a = state.in_lengths((*found.near_points)[0]);
    const std::optional<Point> on_b = state.in_lengths((*found.near_points)[1]);
    found.near_points = on_a && on_b ? std::optional(std::array{*on_a, *on_b}) : std::nullopt;
  }
  return found;
}

CertifiedDistance ModelSearch::certified(const Pose& pose, const SearchedDistance& found,
                                         const SearchOptions& options) const {
  if (state_->meshes) return state_->meshes->certified(pose, found, options);
  const ScaledSearch& state = *state_->superquadrics;
  if (state.unit == 1.0) return state.search.certified(pose, found, options);
  return verify::PairSearch(state.a, state.b).certified(pose, found, options);
}

}  // namespace verisq
