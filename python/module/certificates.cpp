/// Certificates as dictionaries, and the checker that proves rows again from them.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/error.hpp>

#include "python/module/arrays.hpp"
#include "python/module/certificate_list.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

py::dict dictionary(const Certificate& certificate) {
  py::list normals;
  for (const Normal& normal : certificate.normals) normals.append(py::make_tuple(normal.primitive, normal.vector));
  py::dict result;
  result["normals"] = normals;
  result["escape"] = certificate.escape;
  result["weights"] = certificate.weights;
  result["witness"] = certificate.witness;
  result["cover"] = certificate.cover;
  return result;
}

py::dict item(const CertificateList& self, py::ssize_t index) {
  const auto size = static_cast<py::ssize_t>(self.certificates.size());
  if (index < 0) index += size;
  if (index < 0 || index >= size) throw py::index_error("no such row");
  return dictionary(self.certificates[static_cast<std::size_t>(index)]);
}

/// What is checked: as many of each.
struct ClaimedRows {
  std::vector<double> lo;
  std::vector<double> hi;
  const std::vector<Certificate>& certificates;
};

std::vector<double> ends(const py::handle& object, const char* name, std::size_t size) {
  const py::array_t<double, py::array::c_style | py::array::forcecast> array(
      numbers(object, name, {static_cast<py::ssize_t>(size)}));
  const std::vector<double> result(array.data(), array.data() + array.size());
  for (const double end : result) {
    if (std::isnan(end)) throw Error(ErrorKind::input, fmt::format("{} has an end that is no number", name));
  }
  return result;
}

struct PythonFindings {
  py::array_t<std::uint8_t> verdict;
  py::array_t<double> lo;
  py::array_t<double> hi;

  static constexpr std::size_t members = 3;
};

template <class Query>
void check_finite(const std::vector<Query>& queries) {
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto* const first = reinterpret_cast<const double*>(&queries[i]);
    for (std::size_t k = 0; k < sizeof(Query) / sizeof(double); ++k) {
      if (!std::isfinite(first[k])) throw Error(ErrorKind::input, fmt::format("row {} is not finite", i));
    }
  }
}

template <class Query>
PythonFindings check(const Checker& checker, const std::vector<Query>& queries, const py::handle& lo,
                     const py::handle& hi, const CertificateList& list) {
  check_finite(queries);
  if (list.certificates.size() != queries.size()) {
    throw py::value_error(
        fmt::format("there are {} certificates for {} rows", list.certificates.size(), queries.size()));
  }
  const ClaimedRows rows{ends(lo, "lo", queries.size()), ends(hi, "hi", queries.size()), list.certificates};
  const auto size = static_cast<py::ssize_t>(queries.size());
  PythonFindings findings{py::array_t<std::uint8_t>(size), py::array_t<double>(size), py::array_t<double>(size)};
  auto* const verdict = findings.verdict.mutable_data();
  auto* const proven_lo = findings.lo.mutable_data();
  auto* const proven_hi = findings.hi.mutable_data();
  Interruption interruption;
  const auto interrupted = interruption.poll();
  without_lock(interruption, [&] {
    for (std::size_t i = 0; i < queries.size() && !interrupted(); ++i) {
      const Finding finding = checker(queries[i], {rows.lo[i], rows.hi[i]}, rows.certificates[i]);
      verdict[i] = static_cast<std::uint8_t>(finding.verdict);
      proven_lo[i] = finding.proven.lo;
      proven_hi[i] = finding.proven.hi;
    }
    return true;
  });
  return findings;
}

}  // namespace

void declare_certificates(py::module_& module) {
  static_assert(static_cast<int>(Verdict::proved) == 0 && static_cast<int>(Verdict::refuted) == 1 &&
                static_cast<int>(Verdict::unproved) == 2);
  py::class_<CertificateList, std::shared_ptr<CertificateList>>(
      module, "Certificates",
      "What proves the rows of a map again, in their order. An item is a dictionary: normals, a list of\n"
      "(primitive, (x, y, z)) in the primitive's own frame; escape, a point, or None; weights, of a triangle, or "
      "None;\n"
      "witness, a point, or None; cover, a list of bool, empty where there is none.")
      .def("__len__", [](const CertificateList& self) { return self.certificates.size(); })
      .def("__getitem__", item)
      .def(pickled<CertificateList>());
  py::class_<PythonFindings>(module, "Findings", "What a Checker found: row i is that of query i.")
      .def_readonly("verdict", &PythonFindings::verdict, "uint8 (N,): values of Verdict.")
      .def_readonly("lo", &PythonFindings::lo, "float64 (N,): what is proven, rounded outward.")
      .def_readonly("hi", &PythonFindings::hi, "float64 (N,)")
      .def_property_readonly(
          "all_proved", [](const PythonFindings& self) { return !self.verdict.attr("any")().cast<bool>(); },
          "Whether every row is proved.")
      .def("__len__", [](const PythonFindings& self) { return self.verdict.size(); })
      .def(pickled<PythonFindings>());
  py::class_<Checker>(
      module, "Checker",
      "Checker(model, point_radius=0.0)\n\nProves the rows of maps again from their certificates: MPFR, "
      "no OpenCL, no solver.\nRaises Error where points have a radius and the model is not a union of primitives.")
      .def(py::init([](const PythonModel& model, double point_radius) {
             check_length(point_radius, "point_radius");
             return std::make_unique<Checker>(model.model(), point_radius);
           }),
           py::arg("model"), py::arg("point_radius") = 0.0)
      .def(
          "points",
          [](const Checker& self, const py::handle& queries, const py::handle& lo, const py::handle& hi,
             const CertificateList& list) { return check(self, points(queries, "points"), lo, hi, list); },
          py::arg("points"), py::arg("lo"), py::arg("hi"), py::arg("certificates"),
          "points(points, lo, hi, certificates) -> Findings\n\nOf a map of points, shape (N, 3), with certificates.\n"
          "PROVED is never said of a row that does not contain the exact distance, whatever the certificate holds.")
      .def(
          "triangles",
          [](const Checker& self, const py::handle& queries, const py::handle& lo, const py::handle& hi,
             const CertificateList& list) { return check(self, triangles(queries, "triangles"), lo, hi, list); },
          py::arg("triangles"), py::arg("lo"), py::arg("hi"), py::arg("certificates"),
          "triangles(triangles, lo, hi, certificates) -> Findings\n\nThe same of a map of triangles, (N, 3, 3).");
}

}  // namespace verisq::python
