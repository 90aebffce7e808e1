/// Stance models: wrench, sensitivities, accelerations, and the bounce of a contact cylinder.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/stance_analysis.hpp>
#include <verisq/stance_bounce.hpp>
#include <verisq/stance_choice.hpp>
#include <verisq/stance_file.hpp>

#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/python_model.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

using Names = std::optional<std::vector<std::string>>;

/// Immutable, as read.
struct PythonStance {
  stance::Model model;
};

std::vector<std::uint32_t> chosen(const PythonStance& self, const Names& names) {
  return names ? stance::uncertain_parameters(self.model, *names) : stance::uncertain_parameters(self.model);
}

stance::Mode mode_of(const std::string& word) {
  if (word == "tight") return stance::Mode::tight;
  if (word == "paper") return stance::Mode::paper;
  throw py::value_error(fmt::format("mode must be \"tight\" or \"paper\", not \"{}\"", word));
}

/// Lower and upper ends, a row each.
py::array_t<double> rows_of(std::span<const Enclosure> enclosures) {
  py::array_t<double> result(std::vector<py::ssize_t>{static_cast<py::ssize_t>(enclosures.size()), 2});
  double* next = result.mutable_data();
  for (const Enclosure& each : enclosures) {
    *next++ = each.lo;
    *next++ = each.hi;
  }
  return result;
}

py::array_t<double> wrench(const PythonStance& self, const Names& uncertain, const std::string& mode) {
  return rows_of(stance::wrench(self.model, chosen(self, uncertain), mode_of(mode)));
}

py::dict sensitivities(const PythonStance& self, const Names& uncertain, const std::string& mode) {
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  const stance::Mode how = mode_of(mode);
  py::dict result;
  for (std::uint32_t i = 0; i < self.model.parameters.size(); ++i) {
    result[py::str(self.model.parameters[i].name)] = rows_of(stance::sensitivity(self.model, over, i, how));
  }
  return result;
}

py::tuple reference_uncertainty(const PythonStance& self, const Names& uncertain, const std::string& mode) {
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  const stance::ReferenceUncertainty found = stance::reference_uncertainty(self.model, over, over, mode_of(mode));
  return py::make_tuple(rows_of(found.by_value), py::array_t<double>(stance::wrench_size, found.by_radius.data()));
}

py::array_t<double> accelerations(const PythonStance& self, const Names& uncertain, std::uint32_t cells) {
  constexpr std::uint32_t most = 4096;
  if (cells < 1 || cells > most) throw py::value_error(fmt::format("cells must be 1 to {}, not {}", most, cells));
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  stance::check_cells(cells, over.size());
  Interruption interruption;
  return rows_of(without_lock(interruption, [&] {
    return stance::accelerations(self.model, over, {.cells = cells, .interrupted = interruption.poll()});
  }));
}

stance::Bounce bounce(const PythonStance& self, const std::string& cylinder, double height, const Names& uncertain) {
  check_length(height, "height");
  if (height == 0.0) throw py::value_error("height must be above 0");
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  const stance::Drop drop = stance::drop_of(self.model, stance::cylinder_of(self.model, cylinder), over, height);
  Interruption interruption;
  return without_lock(interruption, [&] { return stance::bounce(drop, {.interrupted = interruption.poll()}); });
}

py::list parameters(const PythonStance& self) {
  py::list result;
  for (const stance::Parameter& parameter : self.model.parameters) {
    py::dict each;
    each["name"] = parameter.name;
    each["unit"] = parameter.unit;
    each["description"] = parameter.description;
    each["nominal"] = parameter.nominal;
    each["range"] = parameter.range;
    result.append(each);
  }
  return result;
}

std::vector<std::string> cylinders(const PythonStance& self) {
  std::vector<std::string> names;
  for (const stance::ContactCylinder& cylinder : self.model.cylinders) names.push_back(cylinder.name);
  return names;
}

void declare_bounces(py::module_& module) {
  py::class_<stance::Bounce>(module, "Bounce", "What StanceModel.bounce() encloses: of all numbers of the drop.")
      .def_readonly("touch_down_time", &stance::Bounce::touch_down_time, "s")
      .def_readonly("touch_down_speed", &stance::Bounce::touch_down_speed, "m/s")
      .def_readonly("lift_off_time", &stance::Bounce::lift_off_time,
                    "s; its upper end is infinite where the body may stay on the ground.")
      .def_readonly("rebound_speed", &stance::Bounce::rebound_speed, "m/s; 0 where the body stays on the ground.")
      .def_readonly("deepest_penetration", &stance::Bounce::deepest_penetration, "m")
      .def_readonly("effective_restitution", &stance::Bounce::effective_restitution,
                    "Rebound speed divided by touch-down speed.")
      .def_readonly("proven", &stance::Bounce::proven, "False: the integration gave up; ends may then be infinite.");
}

}  // namespace

void declare_stances(py::module_& module) {
  declare_bounces(module);
  py::class_<PythonStance>(
      module, "StanceModel",
      "A model of human stance (XML, docs/stance.md), whose parameters may be uncertain. Ground contact, friction and\n"
      "the controller act in none of its analyses but bounce(). `uncertain` names the parameters that take their "
      "whole\n"
      "range; None: all that have one. Raises Error for names that the model does not have.")
      .def_static(
          "load", [](const std::filesystem::path& path) { return PythonStance{stance::read_model(path)}; },
          py::arg("path"), "load(path) -> StanceModel\n\nRaises Error, one line with file, line and value.")
      .def_static(
          "loads",
          [](const std::string& text, const std::string& name) {
            return PythonStance{stance::parse_model(text, name)};
          },
          py::arg("text"), py::arg("name") = "model",
          "loads(text, name=\"model\") -> StanceModel\n\nThe same from XML; name stands for the file in messages.")
      .def_property_readonly("parameters", parameters,
                             "A list of dictionaries: name, unit, description, nominal, range (an Enclosure).")
      .def_property_readonly(
          "joints", [](const PythonStance& self) { return stance::joint_names(self.model); },
          "\"pelvis ty\", ...: the rows of accelerations().")
      .def_property_readonly("cylinders", cylinders, "The names that bounce() knows.")
      .def("wrench", wrench, py::arg("uncertain") = py::none(), py::kw_only(), py::arg("mode") = "tight",
           "wrench(uncertain=None, *, mode=\"tight\") -> array\n\n"
           "float64 (6, 2): lower and upper ends of the wrench of gravity and the applied force on the root, at rest:\n"
           "forces along x, y, z (N), moments about x, y, z (N m). mode \"paper\": with the paper's expression of the\n"
           "last one, in which px occurs three times.")
      .def("sensitivities", sensitivities, py::arg("uncertain") = py::none(), py::kw_only(), py::arg("mode") = "tight",
           "sensitivities(uncertain=None, *, mode=\"tight\") -> dict\n\n"
           "Of every parameter, by its name, the wrench's partial derivatives by it over the box: float64 (6, 2).")
      .def("reference_uncertainty", reference_uncertainty, py::arg("uncertain") = py::none(), py::kw_only(),
           py::arg("mode") = "tight",
           "reference_uncertainty(uncertain=None, *, mode=\"tight\") -> tuple\n\n"
           "The sum over the parameters of |derivative| times the range, float64 (6, 2), as in the paper; and times\n"
           "half the range's width, float64 (6,), rounded up.")
      .def(
          "accelerations", accelerations, py::arg("uncertain") = py::none(), py::kw_only(), py::arg("cells") = 64,
          "accelerations(uncertain=None, *, cells=64) -> array\n\n"
          "float64 (J, 2): lower and upper ends of the accelerations of all joints in free fall, m/s^2 or rad/s^2;\n"
          "infinite where nothing is proven. cells: subdivisions of each uncertain range, 1 to 4096. Raises Error for\n"
          "more than 1e9 cells in all.")
      .def("bounce", bounce, py::arg("cylinder"), py::kw_only(), py::arg("height") = 0.01,
           py::arg("uncertain") = py::none(),
           "bounce(cylinder, *, height=0.01, uncertain=None) -> Bounce\n\n"
           "Drops this contact cylinder alone, with the mass of its body, from so many metres.")
      .def("__repr__", [](const PythonStance& self) {
        return fmt::format("<verisq.StanceModel: {} bodies, {} parameters>", self.model.bodies.size(),
                           self.model.parameters.size());
      });
}

}  // namespace verisq::python
