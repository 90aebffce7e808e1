/// Proves bounds of fits again, of the implants and the mesh that it is given.
#include "python/module/certified_bound.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <vector>

#include "python/module/interruption.hpp"
#include "python/module/python_mesh.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

std::vector<Model> exact_models(const py::object& implants) {
  if (py::isinstance<PythonModel>(implants)) return {implants.cast<const PythonModel&>().exact("is_proved")};
  std::vector<Model> models;
  for (const py::handle& each : implants) models.push_back(each.cast<const PythonModel&>().exact("is_proved"));
  return models;
}

bool is_proved(const PythonCertifiedBound& self, const py::object& implants, const PythonMesh& mesh) {
  const std::vector<Model> models = exact_models(implants);
  Interruption interruption;
  const auto interrupted = interruption.poll();
  return without_lock(interruption, [&] {
    const BestFitChecker checker(models, mesh.mesh.vertices, self.claim);
    CheckOptions options;
    options.interrupted = interrupted;
    return check(self.claim, checker(self.certificate, options)) == Verdict::proved;
  });
}

std::size_t boxes_of(const PythonCertifiedBound& self) {
  std::size_t boxes = 0;
  for (const std::vector<PoseDivision>& range : self.certificate.ranges) boxes += (range.size() + 1) / 2;
  return boxes;
}

}  // namespace

void declare_class_of_certified_bounds(py::module_& module) {
  py::class_<PythonCertifiedBound>(module, "CertifiedBound", "How good a fit can be at best, proven twice.")
      .def_property_readonly(
          "upper", [](const PythonCertifiedBound& self) { return self.claim.upper; },
          "No pose of the range whose vertices all keep the limit has a larger objective: what the certificate proves; "
          "-inf:\nthere is none.")
      .def_property_readonly("boxes", boxes_of, "Of poses, that it bounds.")
      .def("is_proved", is_proved, py::arg("implants"), py::arg("mesh"),
           "is_proved(implants, mesh) -> bool\n\n"
           "Proves it again, of these implants (a Model or a sequence of them, as fit() was given them) and this mesh, "
           "by\nintervals and the certificate alone. Raises Error for other numbers of implants or vertices.")
      .def("__repr__",
           [](const PythonCertifiedBound& self) {
             return fmt::format("<verisq.CertifiedBound: at most {}>", self.claim.upper);
           })
      .def(pickled<PythonCertifiedBound>());
}

}  // namespace verisq::python
