/// The classes verisq.CertifiedBound and verisq.CertifiedContact: what proves a fit's bound and contact again.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <vector>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

std::vector<Model> exact_models(const py::object& implants) {
  if (py::isinstance<PythonModel>(implants)) return {implants.cast<const PythonModel&>().exact("is_proved")};
  std::vector<Model> models;
  for (const py::handle& each : implants) models.push_back(each.cast<const PythonModel&>().exact("is_proved"));
  return models;
}

bool bound_is_proved(const PythonCertifiedBound& self, const py::object& implants, const PythonMesh& mesh) {
  const std::vector<Model> models = exact_models(implants);
  return without_lock([&](const Interrupted& interrupted) {
    const BestFitChecker checker(models, mesh.mesh.vertices, self.claim);
    CheckOptions options;
    options.interrupted = interrupted;
    return check(self.claim, checker(self.certificate, options)) == Verdict::proved;
  });
}

PythonAnswer answer_of_bound(const PythonCertifiedBound& self, const std::vector<std::filesystem::path>& implants,
                             const std::filesystem::path& mesh) {
  const BestFitClaim& claim = self.claim;
  BestFitAnswer answer{
      .models = {},
      .mesh = subject_file(mesh),
      .units = units_of(implants),
      .terms = {claim.terms.fitness, claim.terms.penetration_limit, claim.terms.areas, runs_of(claim.terms.area_of)},
      .range = claim.range,
      .centres = claim.centres,
      .upper = claim.upper,
      .certificate = self.certificate};
  for (const std::filesystem::path& implant : implants) answer.models.push_back(subject_file(implant));
  return {std::move(answer)};
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
      .def("is_proved", bound_is_proved, py::arg("implants"), py::arg("mesh"),
           "is_proved(implants, mesh) -> bool\n\n"
           "Proves it again, of these implants (a Model or a sequence of them, as fit() was given them) and this mesh, "
           "by\nintervals and the certificate alone. Raises Error for other numbers of implants or vertices.")
      .def("answer", answer_of_bound, py::arg("implants"), py::arg("mesh"),
           "answer(implants, mesh) -> Answer\n\n"
           "What `verisq fit --bound-certificate-file` writes: of these model files, a list, and this mesh file.")
      .def("__repr__",
           [](const PythonCertifiedBound& self) {
             return fmt::format("<verisq.CertifiedBound: at most {}>", self.claim.upper);
           })
      .def(pickled<PythonCertifiedBound>());
}

namespace {

namespace py = pybind11;

py::dict numbers_of(const ContactClaim& claim) {
  using namespace py::literals;  // NOLINT(google-build-using-namespace): pybind11's way to name arguments
  return py::dict("area"_a = claim.area, "within"_a = claim.within, "percent"_a = claim.percent);
}

/// By the names that `keep` knows them by.
py::dict claims_of(const PythonCertifiedContact& self) {
  py::dict result;
  result["contact"] = numbers_of(self.claims.of_mesh);
  for (std::size_t k = 0; k < self.areas.size(); ++k)
    result[py::str("contact:" + self.areas[k])] = numbers_of(self.claims.by_region[k]);
  if (self.claims.of_model) result["implant_contact"] = numbers_of(*self.claims.of_model);
  return result;
}

PythonAnswer answer_of_contact(const PythonCertifiedContact& self, const std::filesystem::path& model,
                               const std::filesystem::path& mesh) {
  return {ContactAnswer{.model = subject_file(model),
                        .mesh = subject_file(mesh),
                        .units = units_of({model}),
                        .distance = self.terms.distance,
                        .regions = self.areas,
                        .region_runs = runs_of(self.terms.region_of),
                        .claims = self.claims,
                        .counted = self.terms.counted,
                        .certificate = self.certificate}};
}

bool contact_is_proved(const PythonCertifiedContact& self, const PythonModel& model, const PythonMesh& mesh) {
  const Model& exact = model.exact("is_proved");
  const ContactTerms& terms = self.terms;
  if (mesh.mesh.vertices.size() != self.certificate.vertices.size()) return false;
  if (!terms.counted.empty() && terms.counted.size() != exact.primitives.size()) return false;
  if (terms.regions > 0 && terms.region_of.size() != mesh.mesh.triangles.size()) return false;
  return without_lock([&](const Interrupted& interrupted) {
    CheckOptions options;
    options.interrupted = interrupted;
    return are_proved(self.claims, ContactChecker(exact)(mesh.mesh, terms, self.certificate, options));
  });
}

}  // namespace

void declare_class_of_certified_contacts(py::module_& module) {
  py::class_<PythonCertifiedContact>(module, "CertifiedContact", "How much of a mesh is in contact, proven twice.")
      .def_property_readonly(
          "distance", [](const PythonCertifiedContact& self) { return self.terms.distance; },
          "No farther from the model's surface is contact.")
      .def_property_readonly("claims", claims_of,
                             "For the mesh, each area and, where it was asked for, the implant's own surface, by the "
                             "names of `keep`,\na dictionary of Enclosures: \"area\" of all, \"within\" of what is in "
                             "contact, \"percent\".")
      .def_property_readonly(
          "counted", [](const PythonCertifiedContact& self) { return self.terms.counted; },
          "Of each primitive whether \"implant_contact\" is of its surface; empty without that.")
      .def("is_proved", contact_is_proved, py::arg("model"), py::arg("mesh"),
           "is_proved(model, mesh) -> bool\n\n"
           "Proves every number again, of this model (Fit.model) and this mesh, by MPFR and the certificates alone.")
      .def("answer", answer_of_contact, py::arg("model"), py::arg("mesh"),
           "answer(model, mesh) -> Answer\n\n"
           "What `verisq fit --contact-certificate-file` writes: of the file of Fit.model, and this mesh file.")
      .def("__repr__",
           [](const PythonCertifiedContact& self) {
             const auto& [lo, hi] = self.claims.of_mesh.percent;
             return fmt::format("<verisq.CertifiedContact: {} to {} % in contact>", lo, hi);
           })
      .def(pickled<PythonCertifiedContact>());
}

}  // namespace verisq::python
