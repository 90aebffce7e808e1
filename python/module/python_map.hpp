/// The classes verisq.Map, verisq.ClosestPointMap and verisq.Certificates: rows as arrays, and what proves them again.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>

namespace verisq::python {

// The class verisq.Certificates: what proves the rows of a map again, kept as the library has it.

/// One for each row, in the order of the map.
struct CertificateList {
  std::vector<Certificate> certificates;

  static constexpr std::size_t members = 1;
};

// The class verisq.ClosestPointMap, and what fills it.

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

// The class verisq.Map: rows as arrays, and what is said of all of them.

static_assert(sizeof(Status) == 1);

/// A finished map: its columns are arrays.
struct PythonMap {
  pybind11::array_t<double> lo;
  pybind11::array_t<double> hi;
  pybind11::array_t<std::uint8_t> status;
  std::shared_ptr<const CertificateList> certificates;  ///< null unless asked for
  MapSummary summary;
  double tolerance;

  static constexpr std::size_t members = 6;
};

/// Of so many rows, which are not set.
[[nodiscard]] PythonMap empty_map(std::size_t size, double tolerance);

/// Where its rows are.
[[nodiscard]] ResultColumns columns(PythonMap& map);

/// A copy of finished rows.
[[nodiscard]] PythonMap map_of_rows(std::span<const MapResult> rows, const MapSummary& summary, double tolerance);

}  // namespace verisq::python
