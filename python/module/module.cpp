/// The compiled part of the Python package `verisq`: the library's classes, and arrays on their way in and out.
#include <pybind11/pybind11.h>

#include <verisq/version.hpp>

#include "python/module/declarations.hpp"

PYBIND11_MODULE(_verisq, module) {
  // Docstrings begin with signatures in the package's own words; _verisq.pyi has the types.
  pybind11::options options;
  options.disable_function_signatures();
  module.doc() = "The compiled part of the package verisq.";
  module.attr("__version__") = VERISQ_VERSION;
  verisq::python::declare_errors(module);
  verisq::python::declare_enclosures(module);
  verisq::python::declare_models(module);
  verisq::python::declare_signed_distance(module);
  verisq::python::declare_meshes(module);
  verisq::python::declare_class_of_maps(module);
  verisq::python::declare_maps(module);
  verisq::python::declare_certificates(module);
  verisq::python::declare_closest_points(module);
  verisq::python::declare_closest_pairs(module);
  verisq::python::declare_pairs(module);
  verisq::python::declare_paths(module);
  verisq::python::declare_deviations(module);
  verisq::python::declare_recoveries(module);
  verisq::python::declare_features(module);
  verisq::python::declare_octrees(module);
  verisq::python::declare_clearances(module);
  verisq::python::declare_insertions(module);
  verisq::python::declare_fits(module);
  verisq::python::declare_stances(module);
  verisq::python::declare_devices(module);
}
