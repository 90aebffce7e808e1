/// Stance models: wrench, sensitivities, accelerations, and the bounce of a contact cylinder.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

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

void check_finest(std::uint32_t cells) {
  constexpr std::uint32_t most = 4096;
  if (cells < 1 || cells > most) throw py::value_error(fmt::format("cells must be 1 to {}, not {}", most, cells));
}

stance::AccelerationCase case_of(const std::string& word) {
  for (const auto at :
       {stance::AccelerationCase::fall, stance::AccelerationCase::contact, stance::AccelerationCase::standing}) {
    if (word == to_string(at)) return at;
  }
  throw py::value_error(fmt::format("at must be \"fall\", \"contact\" or \"standing\", not \"{}\"", word));
}

py::array_t<double> accelerations(const PythonStance& self, const Names& uncertain, std::uint32_t cells,
                                  const std::string& at, const std::map<std::string, double>& joints) {
  check_finest(cells);
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  const stance::AccelerationCase how = case_of(at);
  std::vector<stance::JointPosition> elsewhere;
  elsewhere.reserve(joints.size());
  for (const auto& [name, position] : joints) elsewhere.push_back(stance::joint_position(self.model, name, position));
  return rows_of(without_lock([&](const Interrupted& interrupted) {
    return stance::accelerations(self.model, over, stance::instant(self.model, how, elsewhere),
                                 {.cells = cells, .interrupted = interrupted});
  }));
}

stance::Bounce bounce(const PythonStance& self, const std::string& cylinder, double height, const Names& uncertain) {
  check_length(height, "height");
  if (height == 0.0) throw py::value_error("height must be above 0");
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  const stance::Drop drop = stance::drop_of(self.model, stance::cylinder_of(self.model, cylinder), over, height);
  return without_lock(
      [&](const Interrupted& interrupted) { return stance::bounce(drop, {.interrupted = interrupted}); });
}

/// One of the model's ranges is narrower.
PythonStance narrowed(const PythonStance& self, const std::string& name, double lo, double hi) {
  const std::uint32_t parameter = stance::parameter_named(self.model, name, "{} is not one of the parameters {}");
  return {stance::narrowed(self.model, parameter, {lo, hi})};
}

PythonStance within(const PythonStance& self, double per_cent, const Names& uncertain) {
  check_length(per_cent, "per_cent");
  return {stance::narrowed_within(self.model, chosen(self, uncertain), per_cent)};
}

/// What is found, and what its numbers are of.
struct PythonEquilibrium {
  stance::Equilibrium found;
  std::vector<std::string> parameters;  ///< uncertain ones
  std::vector<std::string> cylinders;
};

/// What its certificate proves, and what its numbers are of.
struct PythonCertifiedEquilibrium {
  stance::EquilibriumClaims claims;
  stance::EquilibriumCertificate certificate;
  std::vector<std::string> cylinders;
};

stance::JointControl control_of(const std::string& word) {
  if (word == "held") return stance::JointControl::held;
  if (word == "proportional") return stance::JointControl::proportional;
  throw py::value_error(fmt::format("joints must be \"held\" or \"proportional\", not \"{}\"", word));
}

std::vector<std::string> cylinders(const PythonStance& self) {
  std::vector<std::string> names;
  for (const stance::ContactCylinder& cylinder : self.model.cylinders) names.push_back(cylinder.name);
  return names;
}

PythonEquilibrium equilibrium(const PythonStance& self, const std::string& joints, const Names& uncertain,
                              std::uint32_t cells) {
  check_finest(cells);
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  PythonEquilibrium result{{}, {}, cylinders(self)};
  for (const std::uint32_t i : over) result.parameters.push_back(self.model.parameters[i].name);
  result.found = without_lock([&](const Interrupted& interrupted) {
    return stance::equilibrium(self.model, over,
                               {.control = control_of(joints), .cells = cells, .interrupted = interrupted});
  });
  return result;
}

CheckOptions check_options(Interruption& interruption) {
  CheckOptions options;
  options.interrupted = interruption.poll();
  return options;
}

PythonCertifiedEquilibrium certified_equilibrium(const PythonStance& self, const std::string& joints,
                                                 const Names& uncertain, std::uint32_t cells) {
  const PythonEquilibrium found = equilibrium(self, joints, uncertain, cells);
  Interruption interruption;
  stance::CertifiedEquilibrium certified = without_lock(interruption, [&] {
    return stance::certified_equilibrium(self.model, chosen(self, uncertain), control_of(joints), found.found,
                                         check_options(interruption));
  });
  return {std::move(certified.claims), std::move(certified.certificate), found.cylinders};
}

/// A certificate names parameters and joints by their places.
bool is_of(const stance::EquilibriumClaims& claims, const stance::Model& model) {
  for (std::size_t i = 0; i < claims.uncertain.size(); ++i) {
    const std::uint32_t k = claims.uncertain[i];
    if (k >= model.parameters.size()) return false;
    const auto& [lo, hi] = model.parameters[k].range;
    if (claims.ranges[i].lo < lo || claims.ranges[i].hi > hi) return false;
  }
  return !claims.standing || (claims.standing->positions.size() == model.degrees_of_freedom() &&
                              claims.standing->loads.size() == model.cylinders.size());
}

bool is_proved(const PythonCertifiedEquilibrium& self, const PythonStance& model) {
  if (!is_of(self.claims, model.model)) return false;
  Interruption interruption;
  const stance::ProvenEquilibrium proven = without_lock(interruption, [&] {
    return stance::prove(model.model, self.claims, self.certificate, check_options(interruption));
  });
  return !proven.interrupted && std::ranges::all_of(stance::check(self.claims, proven), [](const Finding& finding) {
    return finding.verdict == Verdict::proved;
  });
}

PythonAnswer answer_of(const PythonCertifiedEquilibrium& self, const std::filesystem::path& file) {
  const stance::Model model = stance::read_model(file);
  if (!is_of(self.claims, model)) throw py::value_error(file.string() + ": is another model of stance");
  EquilibriumAnswer answer{.model = subject_file(file),
                           .parameters = {},
                           .joints = stance::joint_names(model),
                           .cylinders = self.cylinders,
                           .claims = self.claims,
                           .certificate = self.certificate};
  for (const std::uint32_t k : self.claims.uncertain) answer.parameters.push_back(model.parameters[k].name);
  return {std::move(answer)};
}

const std::optional<stance::Standing>& standing_of(const PythonEquilibrium& self) {
  return self.found.standing;
}
const std::optional<stance::Standing>& standing_of(const PythonCertifiedEquilibrium& self) {
  return self.claims.standing;
}

/// Of a member of Standing where something stands, else None.
template <class Self, class Member>
auto of_standing(const Member& member) {
  return [member](const Self& self) -> py::object {
    if (!standing_of(self)) return py::none();
    return member(self, *standing_of(self));
  };
}

/// Of what is found over parts of a box.
template <class Found>
py::list cells_of(const Found& self) {
  py::list result;
  for (const auto& cell : self.found.cells) {
    py::dict each;
    each["verdict"] = py::str(std::string(to_string(cell.verdict)));
    py::dict ranges;
    for (std::size_t k = 0; k < cell.ranges.size(); ++k) ranges[py::str(self.parameters[k])] = cell.ranges[k];
    each["parameters"] = ranges;
    result.append(each);
  }
  return result;
}

template <class Self>
void declare_standing(py::class_<Self>& type) {
  using stance::Standing;
  const auto rows = [](std::vector<Enclosure> Standing::*member) {
    return of_standing<Self>(
        [member](const Self&, const Standing& standing) -> py::object { return rows_of(standing.*member); });
  };
  const auto one = [](Enclosure Standing::*member) {
    return of_standing<Self>(
        [member](const Self&, const Standing& standing) -> py::object { return py::cast(standing.*member); });
  };
  const auto loads = [](Enclosure stance::CylinderLoad::*member) {
    return of_standing<Self>([member](const Self& self, const Standing& standing) -> py::object {
      py::dict result;
      for (std::size_t c = 0; c < self.cylinders.size(); ++c)
        result[py::str(self.cylinders[c])] = standing.loads[c].*member;
      return result;
    });
  };
  type.def_property_readonly("positions", rows(&Standing::positions), "float64 (J, 2): of all joints, m or rad.")
      .def_property_readonly("torques", rows(&Standing::torques), "float64 (J, 2): what holds the joints, N m or N.")
      .def_property_readonly("forces", loads(&stance::CylinderLoad::force), "By cylinder: N, upward.")
      .def_property_readonly("penetrations", loads(&stance::CylinderLoad::penetration), "By cylinder: m.")
      .def_property_readonly("least_penetration", one(&Standing::least_penetration), "m, of all points of contact.")
      .def_property_readonly("centre_of_pressure_x", one(&Standing::centre_of_pressure_x), "m")
      .def_property_readonly("centre_of_pressure_z", one(&Standing::centre_of_pressure_z), "m")
      .def(pickled<Self>());
}

void declare_equilibria(py::module_& module) {
  py::class_<PythonEquilibrium> found(
      module, "Equilibrium",
      "What StanceModel.equilibrium() proves, over the box of the uncertain parameters. Ends "
      "are those of all parts\nof the box that are proven to stand; None where there are none.");
  found
      .def_property_readonly(
          "stands", [](const PythonEquilibrium& self) { return self.found.stands; },
          "Share of the box: an equilibrium on all cylinders is proven, stable or not. 1 only for all of it.")
      .def_property_readonly(
          "not_on_all", [](const PythonEquilibrium& self) { return self.found.not_on_all; },
          "Share of the box: proven that none near the file's posture is on all cylinders.")
      .def_property_readonly(
          "open", [](const PythonEquilibrium& self) { return self.found.open; }, "Share of the box: neither is proven.")
      .def_property_readonly(
          "cells", cells_of<PythonEquilibrium>,
          "A list of dictionaries: verdict; parameters, the range of each uncertain one by its name.")
      .def("__repr__", [](const PythonEquilibrium& self) {
        return fmt::format("<verisq.Equilibrium: {:.4g} % stands, {:.4g} % open>", 100.0 * self.found.stands,
                           100.0 * self.found.open);
      });
  declare_standing(found);
  py::class_<PythonCertifiedEquilibrium> certified(
      module, "CertifiedEquilibrium",
      "What the certificate of StanceModel.certified_equilibrium() proves: ends as of an Equilibrium.");
  certified
      .def_property_readonly(
          "stands", [](const PythonCertifiedEquilibrium& self) { return self.claims.stands; },
          "At least this share of the box has an equilibrium on all cylinders. 1 only for all of it.")
      .def("is_proved", is_proved, py::arg("model"),
           "is_proved(model) -> bool\n\n"
           "Proves every number again, of this StanceModel, by other formulas, in 127 bits.")
      .def("answer", answer_of, py::arg("model"),
           "answer(model) -> Answer\n\nWhat `verisq stance --certificate-file` writes: of this file (.xml).")
      .def("__repr__", [](const PythonCertifiedEquilibrium& self) {
        return fmt::format("<verisq.CertifiedEquilibrium: {:.4g} % stands>", 100.0 * self.claims.stands);
      });
  declare_standing(certified);
}

/// What is found, and what its numbers are of.
struct PythonStability {
  stance::Stability found;
  std::vector<std::string> parameters;  ///< uncertain ones
};

PythonStability stability(const PythonStance& self, const std::string& joints, const Names& uncertain,
                          std::uint32_t cells) {
  check_finest(cells);
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  PythonStability result{};
  for (const std::uint32_t i : over) result.parameters.push_back(self.model.parameters[i].name);
  result.found = without_lock([&](const Interrupted& interrupted) {
    return stance::stability(self.model, over,
                             {.control = control_of(joints), .cells = cells, .interrupted = interrupted});
  });
  return result;
}

py::list eigenvalues_of(const PythonStability& self) {
  py::list result;
  for (const stance::EigenvalueEnclosure& eigenvalue : self.found.eigenvalues) {
    py::dict each;
    each["real"] = eigenvalue.real;
    each["imaginary"] = eigenvalue.imaginary;
    each["count"] = eigenvalue.count;
    result.append(each);
  }
  return result;
}

void declare_stabilities(py::module_& module) {
  py::class_<PythonStability>(module, "Stability",
                              "What StanceModel.stability() proves, over the box of the uncertain parameters.")
      .def_property_readonly(
          "stable", [](const PythonStability& self) { return self.found.stable; },
          "Share of the box: small disturbances are proven to die out. 1 only for all of it.")
      .def_property_readonly(
          "unstable", [](const PythonStability& self) { return self.found.unstable; },
          "Share of the box: some disturbances are proven to grow, however small they are. 1 only for all of it.")
      .def_property_readonly(
          "open", [](const PythonStability& self) { return self.found.open; }, "Share of the box: neither is proven.")
      .def_property_readonly(
          "growth",
          [](const PythonStability& self) -> py::object {
            if (self.found.growth.lo > self.found.growth.hi) return py::none();
            return py::cast(self.found.growth);
          },
          "The greatest real part of an eigenvalue where it is not open, 1/s; None where all is.")
      .def_property_readonly(
          "eigenvalues", eigenvalues_of,
          "Dictionaries: real, imaginary (1/s), count; rightmost first. Empty where the box took several cells.")
      .def_property_readonly(
          "cells", cells_of<PythonStability>,
          "A list of dictionaries: verdict; parameters, the range of each uncertain one by its name.")
      .def("__repr__",
           [](const PythonStability& self) {
             return fmt::format("<verisq.Stability: {:.4g} % stable, {:.4g} % unstable>", 100.0 * self.found.stable,
                                100.0 * self.found.unstable);
           })
      .def(pickled<PythonStability>());
}

/// Force, start, duration, as of --push.
std::optional<stance::Push> push_of(const std::optional<std::array<double, 3>>& given) {
  if (!given) return std::nullopt;
  const auto& [force, start, duration] = *given;
  if (!std::isfinite(force)) throw py::value_error(fmt::format("push: the force must be finite, not {}", force));
  check_length(start, "push: the start");
  check_length(duration, "push: the duration");
  if (duration == 0.0) throw py::value_error("push: the duration must be above 0");
  return stance::Push{force, start, duration};
}

stance::Motion simulate(const PythonStance& self, double duration, const Names& uncertain, double lift,
                        const std::optional<double>& drop, const std::optional<std::array<double, 3>>& push) {
  check_length(duration, "duration");
  if (duration == 0.0) throw py::value_error("duration must be above 0");
  check_length(lift, "lift");
  if (drop) check_length(*drop, "drop");
  if (drop && lift != 0.0) throw py::value_error("drop and lift begin at different places: give one");
  const std::vector<std::uint32_t> over = chosen(self, uncertain);
  Interruption interruption;
  stance::MotionOptions options{.duration = duration, .lift = lift, .drop = drop, .push = push_of(push)};
  options.interrupted = interruption.poll();
  return without_lock(interruption, [&] { return stance::simulate(self.model, over, options); });
}

/// Of `count` enclosures of every slab: float64 (S, count, 2).
template <class Part>
auto over_time(std::vector<std::string> stance::Motion::*names, const Part& part) {
  return [names, part](const stance::Motion& self) {
    const std::size_t count = (self.*names).size();
    py::array_t<double> result(
        std::vector<py::ssize_t>{static_cast<py::ssize_t>(self.slabs.size()), static_cast<py::ssize_t>(count), 2});
    double* next = result.mutable_data();
    for (const stance::MotionSlab& slab : self.slabs) {
      for (std::size_t k = 0; k < count; ++k) {
        const Enclosure& each = part(slab, k);
        *next++ = each.lo;
        *next++ = each.hi;
      }
    }
    return result;
  };
}

py::array_t<double> times_of(const stance::Motion& self) {
  std::vector<Enclosure> times;
  for (const stance::MotionSlab& slab : self.slabs) times.push_back({slab.from, slab.to});
  return rows_of(times);
}

void declare_motions(py::module_& module) {
  using stance::Motion;
  using stance::MotionSlab;
  const auto of_joints = [](std::vector<Enclosure> MotionSlab::*member) {
    return over_time(&Motion::joints, [member](const MotionSlab& slab, std::size_t joint) -> const Enclosure& {
      return (slab.*member)[joint];
    });
  };
  const auto of_contacts = [](Enclosure stance::MotionContact::*member) {
    return over_time(&Motion::contacts, [member](const MotionSlab& slab, std::size_t contact) -> const Enclosure& {
      return slab.contacts[contact].*member;
    });
  };
  py::class_<Motion>(
      module, "Motion",
      "What StanceModel.simulate() proves: S slabs of time, one after the other from 0 to `reached`, of J\n"
      "joints and C cylinders or pairs of them. Each slab's enclosures contain all motions, for all\n"
      "parameters of the box, at all times of the slab.")
      .def_readonly("joints", &Motion::joints, "\"pelvis tx\", \"femur rz\", ...; of a pair without its side.")
      .def_readonly("contacts", &Motion::contacts, "Of cylinders, likewise.")
      .def_property_readonly("times", times_of, "float64 (S, 2): where each slab begins and ends, s.")
      .def_property_readonly("positions", of_joints(&MotionSlab::positions), "float64 (S, J, 2): m or rad.")
      .def_property_readonly("velocities", of_joints(&MotionSlab::velocities), "float64 (S, J, 2): m/s or rad/s.")
      .def_property_readonly("normal_forces", of_contacts(&stance::MotionContact::normal),
                             "float64 (S, C, 2): upward on each cylinder, N.")
      .def_property_readonly("friction", of_contacts(&stance::MotionContact::friction),
                             "float64 (S, C, 2): along x on each cylinder, N.")
      .def_property_readonly(
          "final_positions", [](const Motion& self) { return rows_of(self.positions); },
          "float64 (J, 2): at `reached`, m or rad.")
      .def_property_readonly(
          "final_velocities", [](const Motion& self) { return rows_of(self.velocities); },
          "float64 (J, 2): at `reached`, m/s or rad/s.")
      .def_readonly("reached", &Motion::reached, "s: of later times nothing is said.")
      .def_readonly("proven", &Motion::proven, "Whether that is all of the duration.")
      .def_readonly("open", &Motion::open, "Why it ended before, in words; empty where it did not.")
      .def("__repr__",
           [](const Motion& self) {
             return fmt::format("<verisq.Motion: proven to {:.4g} s{}>", self.reached,
                                self.proven ? "" : ", then open");
           })
      .def(pickled<Motion>());
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
      .def_readonly("proven", &stance::Bounce::proven, "False: the integration gave up; ends may then be infinite.")
      .def(pickled<stance::Bounce>());
}

using StanceClass = py::class_<PythonStance>;

void declare_wrench(StanceClass& model) {
  model
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
          py::arg("at") = "fall", py::arg("joints") = std::map<std::string, double>{},
          "accelerations(uncertain=None, *, cells=64, at=\"fall\", joints={}) -> array\n\n"
          "float64 (J, 2): lower and upper ends of the accelerations of all joints, m/s^2 or rad/s^2; infinite where\n"
          "nothing is proven. at: \"fall\" freely; in \"contact\" with the ground, let go at rest in the file's\n"
          "posture; or \"standing\" at rest in the nominal body's equilibrium, held by its torques. joints: positions\n"
          "by name (m or rad) other than the file's; in contact their controllers' proportional parts act. cells:\n"
          "finest divisions of each uncertain range, 1 to 4096; a range is divided only where an acceleration may be\n"
          "largest or smallest. Raises Error for a joint that there is none of, and where the body does not stand.");
}

void declare_standing(StanceClass& model) {
  model
      .def("certified_equilibrium", certified_equilibrium, py::arg("joints") = "held", py::kw_only(),
           py::arg("uncertain") = py::none(), py::arg("cells") = 16,
           "certified_equilibrium(joints=\"held\", *, uncertain=None, cells=16) -> CertifiedEquilibrium\n\n"
           "As equilibrium(), with what proves it again by other formulas, in 127 bits. Ends may be a little wider.")
      .def("equilibrium", equilibrium, py::arg("joints") = "held", py::kw_only(), py::arg("uncertain") = py::none(),
           py::arg("cells") = 16,
           "equilibrium(joints=\"held\", *, uncertain=None, cells=16) -> Equilibrium\n\n"
           "Where the body is in equilibrium on all of its cylinders, stable or not: joints \"held\" where the file "
           "has\n"
           "them, or turned from there as the \"proportional\" gains allow. cells: finest subdivisions of each "
           "uncertain\n"
           "range, 1 to 4096. Raises Error for a model that cannot stand.")
      .def("stability", stability, py::arg("joints") = "held", py::kw_only(), py::arg("uncertain") = py::none(),
           py::arg("cells") = 16,
           "stability(joints=\"held\", *, uncertain=None, cells=16) -> Stability\n\n"
           "Whether small disturbances of that equilibrium die out: with the whole controllers acting (\"held\"), or\n"
           "without their integral parts (\"proportional\"). Raises Error for a model that nothing holds.");
}

void declare_moving(StanceClass& model) {
  model
      .def(
          "simulate", simulate, py::arg("duration"), py::kw_only(), py::arg("uncertain") = py::none(),
          py::arg("lift") = 0.0, py::arg("drop") = py::none(), py::arg("push") = py::none(),
          "simulate(duration, *, uncertain=None, lift=0.0, drop=None, push=None) -> Motion\n\n"
          "How the body moves in its sagittal plane for so many seconds, from its nominal equilibrium on, at rest at\n"
          "first, or let go `lift` metres above it, or in the file's posture, its lowest sole `drop` metres above the\n"
          "ground. push: (force, start, duration) in N, s, s: a force along x on the\n"
          "reference point, force sin^2(pi (t - start)/duration). The arrays of S slabs, J joints, C cylinders or\n"
          "pairs: times (S, 2), positions and velocities (S, J, 2), normal_forces and friction (S, C, 2). Raises "
          "Error\n"
          "for a model that is not mirror-symmetric or that is not proven to stand.")
      .def("narrowed", narrowed, py::arg("name"), py::arg("lo"), py::arg("hi"),
           "narrowed(name, lo, hi) -> StanceModel\n\nWith a part of a parameter's range.")
      .def("within", within, py::arg("per_cent"), py::arg("uncertain") = py::none(),
           "within(per_cent, uncertain=None) -> StanceModel\n\n"
           "With uncertain parameters at most this part of their nominal value off it.")
      .def("bounce", bounce, py::arg("cylinder"), py::kw_only(), py::arg("height") = 0.01,
           py::arg("uncertain") = py::none(),
           "bounce(cylinder, *, height=0.01, uncertain=None) -> Bounce\n\n"
           "Drops this contact cylinder alone, with the mass of its body, from so many metres.");
}

}  // namespace

void declare_stances(py::module_& module) {
  declare_bounces(module);
  declare_equilibria(module);
  declare_stabilities(module);
  declare_motions(module);
  StanceClass model(
      module, "StanceModel",
      "A model of human stance (XML, docs/stance.md), whose parameters may be uncertain. What acts in which\n"
      "analysis: docs/stance.md. `uncertain` names the parameters that take their whole range; None: all that have "
      "one.\n"
      " Raises Error for names that the model does not have.");
  model
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
      .def_property_readonly("cylinders", cylinders, "The names that bounce() knows.");
  declare_wrench(model);
  declare_standing(model);
  declare_moving(model);
  model
      .def("__repr__",
           [](const PythonStance& self) {
             return fmt::format("<verisq.StanceModel: {} bodies, {} parameters>", self.model.bodies.size(),
                                self.model.parameters.size());
           })
      .def(pickled<PythonStance>());
}

}  // namespace verisq::python
