/// Judges the kernel that makes rows of points in one step, by those that do so one after the other.
#pragma once

#include <string>

#include "host/device/device.hpp"

namespace verisq::device {

/// What is wrong with the rows, sums and refusals of point_map in `program`, in memory of several strides: empty where
/// they are those of point_columns, point_distance and point_rows, byte for byte.
[[nodiscard]] std::string false_point_map(const Device& device, const cl::Program& program);

}  // namespace verisq::device
