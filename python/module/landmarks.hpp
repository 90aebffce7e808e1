/// Landmarks of a femur as dictionaries of points, and sides as words.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <verisq/features.hpp>

namespace verisq::python {

/// Points by their names, and "head_radius".
[[nodiscard]] pybind11::dict dictionary(const FemurLandmarks& landmarks);

/// And back. Throws Error(input) for a name that is none.
[[nodiscard]] FemurLandmarks landmarks_of(const pybind11::dict& description);

/// "left", "right" or nothing. Throws ValueError for other words.
[[nodiscard]] std::optional<Side> side_of(const std::optional<std::string>& word);

}  // namespace verisq::python
