/// Judges the kernels between the caller's memory and those of distances, by numbers that are made up: point_rows.cl
/// and point_rows.cl.
#pragma once

#include <string>

#include "host/device/device.hpp"

namespace verisq::device {

/// What is wrong with the columns that point_columns makes of points, in memory of several strides: empty where each
/// coordinate is the scaled one, lanes beyond the end repeat the last point, and what is not finite is told.
[[nodiscard]] std::string false_columns(const Device& device, const cl::Program& program);

/// What is wrong with the rows and sums that point_rows makes of enclosures, extremes of all scales among them: empty
/// where each end is the outermost number that the exact one allows for, each status and sum is what the host says of
/// the rows, and memory between rows stays as it was.
[[nodiscard]] std::string false_rows(const Device& device, const cl::Program& program);

}  // namespace verisq::device
