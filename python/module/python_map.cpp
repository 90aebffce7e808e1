/// The class verisq.Map of module.hpp.

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/error.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

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
  without_lock([&](const Interrupted& interrupted) {
    for (std::size_t i = 0; i < queries.size() && !interrupted(); ++i) {
      const Finding finding = checker(queries[i], {rows.lo[i], rows.hi[i]}, rows.certificates[i], interrupted);
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

namespace {

namespace py = pybind11;

/// The bytes of the array, which are values of the enumeration.
Status* statuses(py::array_t<std::uint8_t>& array) {
  return reinterpret_cast<Status*>(array.mutable_data());
}

py::object smallest(const PythonMap& self) {
  if (self.summary.points == 0) return py::none();
  return py::cast(Enclosure{self.summary.minimum_lo, self.summary.minimum_hi});
}

std::string representation(const PythonMap& self) {
  return fmt::format("<verisq.Map: {} rows, {} wide, by {}>", self.summary.points, self.summary.wide,
                     self.summary.device);
}

py::object verified_rows(const PythonMap& self) {
  return self.status.attr("__ne__")(static_cast<int>(Status::wide));
}

}  // namespace

PythonMap empty_map(std::size_t size, double tolerance) {
  const auto length = static_cast<py::ssize_t>(size);
  return {py::array_t<double>(length),
          py::array_t<double>(length),
          py::array_t<std::uint8_t>(length),
          nullptr,
          {},
          tolerance};
}

ResultColumns columns(PythonMap& map) {
  return {static_cast<std::size_t>(map.lo.size()),
          {map.lo.mutable_data()},
          {map.hi.mutable_data()},
          {statuses(map.status)}};
}

PythonMap map_of_rows(std::span<const MapResult> rows, const MapSummary& summary, double tolerance) {
  PythonMap map = empty_map(rows.size(), tolerance);
  const ResultColumns into = columns(map);
  for (std::size_t i = 0; i < rows.size(); ++i) into.set(i, rows[i]);
  map.summary = summary;
  return map;
}

void declare_class_of_maps(py::module_& module) {
  const auto summary = [](auto MapSummary::*member) {
    return [member](const PythonMap& self) { return self.summary.*member; };
  };
  py::class_<PythonMap>(
      module, "Map",
      "What a map returns: row i of the arrays lo, hi and status is that of query i. The exact value\n"
      "is at least lo[i] and at most hi[i]. lo, hi, status = map takes it apart.")
      .def_readonly("lo", &PythonMap::lo, "float64 (N,): lower ends, in model units.")
      .def_readonly("hi", &PythonMap::hi, "float64 (N,): upper ends, in model units; infinite where none is proven.")
      .def_readonly("status", &PythonMap::status, "uint8 (N,): values of Status.")
      .def_property_readonly("verified", verified_rows,
                             "bool (N,): which rows are at most the tolerance wide. The others are valid, too.")
      .def_property_readonly(
          "certificates", [](const PythonMap& self) { return self.certificates; },
          "What proves each row again (Certificates), where it was asked for; else None.")
      .def_readonly("tolerance", &PythonMap::tolerance, "In model units.")
      .def_property_readonly("smallest", smallest, "Enclosure of the smallest distance of all rows; None without rows.")
      .def_property_readonly("largest_width", summary(&MapSummary::largest_width), "Of all rows.")
      .def_property_readonly("device", summary(&MapSummary::device), "The device's name, or \"host\".")
      .def_property_readonly("device_verified", summary(&MapSummary::device_verified), "How many rows.")
      .def_property_readonly("host_verified", summary(&MapSummary::host_verified), "How many rows.")
      .def_property_readonly("wide", summary(&MapSummary::wide), "How many rows are wider than the tolerance.")
      .def_property_readonly("wide_inside", summary(&MapSummary::wide_inside),
                             "How many of those have a lower end below 0.")
      .def_property_readonly("device_seconds", summary(&MapSummary::device_seconds), "During which kernels ran.")
      .def_property_readonly("host_seconds", summary(&MapSummary::host_seconds), "Wall time of the host's proofs.")
      .def_property_readonly("out_of_time", summary(&MapSummary::out_of_time),
                             "Whether the time limit came while rows were wide.")
      .def_property_readonly("notice", summary(&MapSummary::notice),
                             "Why a device was passed over; empty when nothing is to be said.")
      .def("__len__", [](const PythonMap& self) { return self.lo.size(); })
      .def("__iter__", [](const PythonMap& self) { return py::iter(py::make_tuple(self.lo, self.hi, self.status)); })
      .def("__repr__", representation)
      .def(pickled<PythonMap>());
}

}  // namespace verisq::python
