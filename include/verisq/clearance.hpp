/// Proves how well a posed implant serves a cavity: the certified report of a fit.
#pragma once

#include <verisq/cavity.hpp>
#include <verisq/clearance_report.hpp>
#include <verisq/fitness.hpp>
#include <verisq/map.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Maps all points of the cavity against the posed implant (any model) and sums up. The rows go to `sink` as they come.
/// Of an interrupted map the report is of the rows delivered: the first `map.points` of the cavity. Errors as
/// Mapper.
[[nodiscard]] Clearance certified_clearance(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                                            double penetration_limit, const MapOptions& options,
                                            const Sink<Point>& sink);

}  // namespace verisq
