/// The class verisq.Map: rows as arrays, and what is said of all of them.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <verisq/columns.hpp>
#include <verisq/map.hpp>
#include <verisq/map_result.hpp>

#include "python/module/certificate_list.hpp"

namespace verisq::python {

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
