/// Names and points, one by one.
#include "python/module/landmarks.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <verisq/error.hpp>

#include "python/module/arrays.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

}  // namespace

py::dict dictionary(const FemurLandmarks& landmarks) {
  py::dict result;
  for (const auto& [name, member] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*member) result[name] = *at;
  }
  if (landmarks.head_radius) result["head_radius"] = *landmarks.head_radius;
  return result;
}

FemurLandmarks landmarks_of(const py::dict& description) {
  FemurLandmarks result;
  for (const auto& [key, value] : description) {
    const auto name = key.cast<std::string>();
    bool known = name == "head_radius";
    if (known) result.head_radius = value.cast<double>();
    for (const NamedLandmark& landmark : named_landmarks) {
      if (name != landmark.name) continue;
      result.*landmark.point = point(value);
      known = true;
    }
    if (!known) throw Error(ErrorKind::input, fmt::format("landmarks: no landmark is called {}", name));
  }
  return result;
}

std::optional<Side> side_of(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  if (*word == "left") return Side::left;
  if (*word == "right") return Side::right;
  throw py::value_error(fmt::format("side must be \"left\", \"right\" or None, not \"{}\"", *word));
}

}  // namespace verisq::python
