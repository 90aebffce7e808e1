/// The public class: the map of an ordinary model, or those of the models that bracket an uncertain one.
#include "verisq/map.hpp"

#include <fmt/format.h>

#include "host/maps/bracket_map.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/separate_columns.hpp"
#include "host/maps/uncertain_pose_map.hpp"
#include "verify/placement/displaced_point.hpp"
#include "verify/proof/bracketed.hpp"
#include "verify/proof/uncertain_distance.hpp"
#include "verisq/error.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

using verify::MemberBounds;

/// Of the bracketing models' maps: each end to half the tolerance.
MapOptions of_one_end(const MemberBounds& bounds, MapOptions options) {
  if (bounds.exact()) return options;
  options.tolerance = options.tolerance / 2;
  options.covers = false;  // of several primitives together
  return options;
}

/// The obligation of Bracket: where the primitives of a union move independently of each other, no upper end may be
/// proven by several of them together. Certificates never are.
MapOptions by_single_primitives(const Bracket& models, MapOptions options) {
  if (models.inflated) {
    options.certificates = true;
    options.covers = false;
    options.method = Method::duality;  // the published one has none
  }
  return options;
}

template <class Query>
BracketedMap<Query> maps_of(const Bracket& models, const MapOptions& options);

template <>
BracketedMap<Point> maps_of(const Bracket& models, const MapOptions& options) {
  const auto for_upper_ends = [&](const Model& model) {
    return point_map(model, by_single_primitives(models, options));
  };
  return verify::bracketed(models, for_upper_ends, [&](const Model& model) { return point_map(model, options); });
}

/// Only signed distances need the inflated model, for points deep in a union (see Bracket).
template <>
BracketedMap<Triangle> maps_of(const Bracket& models, const MapOptions& options) {
  Bracket without_inflated = models;
  without_inflated.inflated.reset();
  return verify::bracketed(without_inflated, [&](const Model& model) { return triangle_map(model, options); });
}

BracketedMap<Pose> maps_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  BracketedMap<Pose> maps{pose_map(a.smallest, b.smallest, options), std::nullopt, std::nullopt};
  if (!verify::same_solids(a) || !verify::same_solids(b)) maps.largest = pose_map(a.largest, b.largest, options);
  return maps;
}

template <class Query>
BracketMap<Query> bracket_map_of(const Bracket& models, const MapOptions& options) {
  const MemberBounds bounds(models, options.point_radius);
  return {bounds, options, maps_of<Query>(models, of_one_end(bounds, options))};
}

BracketMap<Pose> bracket_map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  const MemberBounds bounds(a, b);
  return {bounds, options, maps_of(a, b, of_one_end(bounds, options))};
}

void check_uncertain_pose(const MapOptions& options, bool divisible) {
  if (!options.pose_uncertainty) return;
  const auto refuse = [](const char* what) { throw Error(ErrorKind::input, fmt::format("uncertain poses: {}", what)); };
  if (options.certificates) refuse("there are no certificates");
  if (options.tolerance == 0.0) refuse("rows are never narrower than distances differ: the tolerance must be above 0");
  if (options.pose_divisions == 0) refuse("the divisions must be at least 1");
  if (options.pose_divisions > 1 && !divisible) refuse("places are divided for points alone");
}

/// At the nominal pose: distances to a small part of what the motions, which take the model as far as `reach`, leave.
MapOptions at_nominal_pose(MapOptions options, double reach) {
  constexpr double parts = 32.0;
  if (options.pose_uncertainty)
    options.tolerance = std::max(options.tolerance, reach) / (parts * options.pose_divisions);
  return options;
}

double reach_of(const MapOptions& options, const Model& model) {
  return options.pose_uncertainty ? verify::reach_of(*options.pose_uncertainty, model) : 0.0;
}

/// Of points, where the model is one that convexity says more of.
template <class Query>
std::optional<ConvexPoseRows> convex_rows_of(const Bracket& models, const MapOptions& options, double reach) {
  if (!std::same_as<Query, Point> || !options.pose_uncertainty) return std::nullopt;
  if (!MemberBounds(models, 0.0).exact() || !is_union_of_convex(models.largest)) return std::nullopt;
  return ConvexPoseRows(models.largest, *options.pose_uncertainty, at_nominal_pose(options, reach));
}

template <class Query>
UncertainPoseMap<Query> map_of(const Bracket& models, const MapOptions& options) {
  check_uncertain_pose(options, std::same_as<Query, Point>);
  const double reach = reach_of(options, models.largest);
  return {options, reach, bracket_map_of<Query>(models, at_nominal_pose(options, reach)),
          convex_rows_of<Query>(models, options, reach)};
}

UncertainPoseMap<Pose> map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  check_uncertain_pose(options, false);
  const double reach = reach_of(options, b.largest);
  return {options, reach, bracket_map_of(a, b, at_nominal_pose(options, reach))};
}

}  // namespace

template <class Query>
struct Mapper<Query>::State {
  UncertainPoseMap<Query> map;
};

// clang 14 instantiates constructors whose constraints do not hold, too.
template <class Query>
Mapper<Query>::Mapper(const UncertainModel& model, const MapOptions& options) requires(!std::same_as<Query, Pose>) {
  if constexpr (!std::same_as<Query, Pose>) state_.reset(new State{map_of<Query>(bracket(model), options)});
}

template <class Query>
Mapper<Query>::Mapper(const UncertainModel& a, const UncertainModel& b,
                      const MapOptions& options) requires std::same_as<Query, Pose> {
  if constexpr (std::same_as<Query, Pose>) state_.reset(new State{map_of(bracket(a), bracket(b), options)});
}

template <class Query>
Mapper<Query>::~Mapper() = default;
template <class Query>
Mapper<Query>::Mapper(Mapper&&) noexcept = default;
template <class Query>
Mapper<Query>& Mapper<Query>::operator=(Mapper&&) noexcept = default;

template <class Query>
MapSummary Mapper<Query>::map(const Source<Query>& source, const Sink<Query>& sink) {
  return state_->map.map(source, sink);
}

template <class Query>
MapSummary Mapper<Query>::map(const Queries& queries, const ResultColumns& rows) {
  if (rows.size() != queries.size())
    throw Error(ErrorKind::input,
                fmt::format("there is memory for {} rows, not for those of {} queries", rows.size(), queries.size()));
  if (state_->map.options().certificates)
    throw Error(ErrorKind::input, "certificates need a sink: columns of rows have no place for them");
  if constexpr (std::same_as<Query, Point>) require_apart(queries, rows);
  return state_->map.map_in_memory(queries, rows);
}

template class Mapper<Point>;
template class Mapper<Triangle>;
template class Mapper<Pose>;

}  // namespace verisq
