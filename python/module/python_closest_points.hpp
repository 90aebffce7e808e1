/// The class verisq.ClosestPointMap, and what fills it.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <vector>
#include <verisq/closest_points.hpp>
#include <verisq/signed_distance.hpp>

namespace verisq::python {

/// What one call found, and of which points.
struct PythonClosestPoints {
  pybind11::array points;
  std::vector<ClosestPoint> rows;
  ClosestPointSummary summary;

  static constexpr std::size_t members = 3;
};

/// Of an array of shape (N, 3), without Python's lock; the tolerance in model units.
[[nodiscard]] PythonClosestPoints closest_points_of(const SignedDistance& distance, const pybind11::handle& points,
                                                    double tolerance);

}  // namespace verisq::python
