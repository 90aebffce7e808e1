/// The class verisq.Answer: any certificate file, loaded, saved, and proved again; and what makes answers of results.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>
#include <string>
#include <variant>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/files.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

/// An answer is pickled as the text of its file.
template <>
struct Packing<Answer> {
  static pybind11::object packed(const Answer& value) { return pybind11::str(text_of(value, "pickled answer")); }
  static Answer unpacked(const pybind11::handle& state) {
    return parse_answer(state.cast<std::string>(), "pickled answer");
  }
};

std::string units_of(const std::vector<std::filesystem::path>& models) {
  for (const std::filesystem::path& model : models)
    if (std::string units = read_uncertain_model(model).units; !units.empty()) return units;
  return "";
}

namespace {

namespace py = pybind11;

/// The files that it is about, in the order in which `check` takes them.
struct Subjects {
  std::vector<SubjectFile> models;
  std::optional<SubjectFile> mesh;
  std::optional<SubjectFile> within;
};

Subjects subjects_of(const Answer& answer) {
  return std::visit(
      []<class Kind>(const Kind& kind) {
        Subjects subjects;
        if constexpr (requires { kind.models; }) subjects.models.assign(kind.models.begin(), kind.models.end());
        if constexpr (requires { SubjectFile(kind.model); }) subjects.models.push_back(kind.model);
        if constexpr (requires { kind.mesh; }) subjects.mesh = kind.mesh;
        if constexpr (requires { kind.implant; })
          if (kind.implant) subjects.models.push_back(*kind.implant);
        if constexpr (requires { kind.removed; })
          if (kind.removed) subjects.within = kind.removed->within;
        return subjects;
      },
      answer);
}

/// {"models": [(name, sha256), ...], "mesh": (name, sha256), ...}
py::dict files_of(const PythonAnswer& self) {
  const auto entry = [](const SubjectFile& file) { return py::make_tuple(file.name, file.sha256); };
  const Subjects subjects = subjects_of(self.answer);
  py::dict files;
  py::list models;
  for (const SubjectFile& model : subjects.models) models.append(entry(model));
  files["models"] = models;
  if (subjects.mesh) files["mesh"] = entry(*subjects.mesh);
  if (subjects.within) files["within"] = entry(*subjects.within);
  return files;
}

std::string units(const PythonAnswer& self) {
  return std::visit(
      [](const auto& kind) -> std::string {
        if constexpr (requires { kind.units; }) return kind.units;
        return "";
      },
      self.answer);
}

using Path = std::optional<std::filesystem::path>;

std::vector<std::filesystem::path> paths_of(const py::object& models) {
  if (models.is_none()) return {};
  if (py::isinstance<py::str>(models) || py::hasattr(models, "__fspath__"))
    return {models.cast<std::filesystem::path>()};
  return models.cast<std::vector<std::filesystem::path>>();
}

JudgedAnswer judged(const PythonAnswer& self, const py::object& models, const Path& mesh, const Path& within,
                    const Path& map, const Path& surface_map) {
  const auto path = [](const Path& given) { return given.value_or(std::filesystem::path()); };
  const AnswerFiles files{paths_of(models), path(mesh), path(within), path(map), path(surface_map)};
  Interruption interruption;
  const CheckOptions options{.interrupted = interruption.poll()};
  return without_lock(interruption, [&] { return judge(self.answer, self.name, files, options); });
}

std::vector<JudgedClaim> check(const PythonAnswer& self, const py::object& models, const Path& mesh, const Path& within,
                               const Path& map, const Path& surface_map) {
  return judged(self, models, mesh, within, map, surface_map).claims;
}

bool is_proved(const PythonAnswer& self, const py::object& models, const Path& mesh, const Path& within,
               const Path& map, const Path& surface_map) {
  return judged(self, models, mesh, within, map, surface_map).all_proved();
}

std::string representation(const JudgedClaim& self) {
  return fmt::format("<verisq.Claim: {}{}{} in [{}, {}]{}: {}>", self.of, self.of.empty() ? "" : ", ", self.what,
                     self.claimed.lo, self.claimed.hi, self.unit.empty() ? "" : " " + self.unit,
                     to_string(self.finding.verdict));
}

void declare_claims(py::module_& module) {
  py::class_<JudgedClaim>(module, "Claim", "One claim of an Answer, and what its certificate proves of it.")
      .def_readonly("of", &JudgedClaim::of, "\"mesh\", \"vertex 12\", \"contact:AREA\"; empty: of the one subject.")
      .def_readonly("what", &JudgedClaim::what, "\"distance\", \"largest\", \"percent\", ...")
      .def_readonly("unit", &JudgedClaim::unit, "\"degrees\", \"m\", ...; empty: none, or Answer.units.")
      .def_readonly("claimed", &JudgedClaim::claimed, "Enclosure: what the answer says; [1, 1] of a statement.")
      .def_property_readonly(
          "proven", [](const JudgedClaim& self) { return self.finding.proven; },
          "Enclosure: what the certificate proves. Of a statement [1, 1], [0, 0], or [0, 1] where it is open.")
      .def_property_readonly(
          "verdict", [](const JudgedClaim& self) { return std::string(to_string(self.finding.verdict)); },
          "\"proved\", \"refuted\" or \"unproved\".")
      .def_readonly("is_unbounded", &JudgedClaim::is_unbounded, "True where it claims nothing on a side.")
      .def("__repr__", representation)
      .def(pickled<JudgedClaim>());
}

constexpr const char* files_in_words =
    "models: the model file or files, in the order of `files`; mesh: the mesh or cloud; within: the surface in which\n"
    "bone lies; map, surface_map: the maps with certificates that belong to a fit. Raises Error for a file that is\n"
    "missing, or is not the one that the answer is about.";

}  // namespace

void declare_answers(py::module_& module) {
  declare_claims(module);
  const auto arguments = [](auto& answer, const char* name, auto function, const std::string& help) {
    answer.def(name, function, py::kw_only(), py::arg("models") = py::none(), py::arg("mesh") = py::none(),
               py::arg("within") = py::none(), py::arg("map") = py::none(), py::arg("surface_map") = py::none(),
               (help + files_in_words).c_str());
  };
  py::class_<PythonAnswer> answer(module, "Answer",
                                  "An answer of any kind with its certificate: what --certificate-file writes.\n"
                                  "Answer.load(file) reads one; the answer() of a certified result makes one.");
  answer
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            return PythonAnswer{read_answer(path), path.string()};
          },
          py::arg("path"),
          "load(path) -> Answer\n\nReads a certificate file. Raises Error for what the format refuses.")
      .def(
          "save", [](const PythonAnswer& self, const std::filesystem::path& path) { write_answer(path, self.answer); },
          py::arg("path"), "save(path)\n\nWrites a certificate file, for `verisq check --certificate`.")
      .def_property_readonly(
          "kind", [](const PythonAnswer& self) { return kind_of(self.answer); },
          "\"pair\", \"poses\", \"path\", \"fit\", \"best_fit\", \"insertion\", \"deviation\", "
          "\"contact\",\n\"containment\", \"features\" or \"equilibrium\".")
      .def_property_readonly("units", units, "Of its lengths, as the model says; \"\" where none are given.")
      .def_property_readonly("files", files_of,
                             "Which files it is about: \"models\", \"mesh\", \"within\", each by name and SHA-256.")
      .def("__repr__",
           [](const PythonAnswer& self) { return fmt::format("<verisq.Answer: {}>", kind_of(self.answer)); })
      .def(pickled<PythonAnswer>());
  arguments(answer, "check", check,
            "check(*, models=None, mesh=None, within=None, map=None, surface_map=None) -> list[Claim]\n\n"
            "Proves every claim again, by MPFR and the certificate alone.\n");
  arguments(answer, "is_proved", is_proved,
            "is_proved(*, models=None, mesh=None, within=None, map=None, surface_map=None) -> bool\n\n"
            "True where check() proves all claims, and none is without an end.\n");
}

}  // namespace verisq::python
