/// What each file of the module adds to it, in the order in which it must: a class before what mentions it.
#pragma once

#include <pybind11/pybind11.h>

namespace verisq::python {

void declare_errors(pybind11::module_& module);
void declare_enclosures(pybind11::module_& module);
void declare_models(pybind11::module_& module);
void declare_signed_distance(pybind11::module_& module);
void declare_meshes(pybind11::module_& module);
void declare_class_of_maps(pybind11::module_& module);
void declare_maps(pybind11::module_& module);
void declare_certificates(pybind11::module_& module);
void declare_closest_points(pybind11::module_& module);
void declare_closest_pairs(pybind11::module_& module);
void declare_pairs(pybind11::module_& module);
void declare_paths(pybind11::module_& module);
void declare_deviations(pybind11::module_& module);
void declare_recoveries(pybind11::module_& module);
void declare_features(pybind11::module_& module);
void declare_octrees(pybind11::module_& module);
void declare_clearances(pybind11::module_& module);
void declare_insertions(pybind11::module_& module);
void declare_fits(pybind11::module_& module);
void declare_stances(pybind11::module_& module);
void declare_devices(pybind11::module_& module);

}  // namespace verisq::python
