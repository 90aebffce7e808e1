/// Reads as many instruments as there are implants, and clears one against the bone.
#include "host/command_line/fit_instrument.hpp"

#include <fmt/core.h>

#include <verisq/model_file.hpp>
#include <verisq/posed_model.hpp>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

std::vector<Instrument> read_instruments(const FitProblem& problem, const FitArguments& arguments) {
  if (arguments.instruments.empty()) return {};
  if (arguments.instruments.size() != arguments.implants.size()) {
    refuse(fmt::format("--instrument: give one for each --implant, in the same order: {} for {}",
                       arguments.instruments.size(), arguments.implants.size()));
  }
  if (problem.mesh.triangles.empty()) {
    refuse(fmt::format("--instrument: {} has no triangles to cut", arguments.mesh));
  }
  std::vector<Instrument> instruments;
  for (const std::string& file : arguments.instruments) {
    instruments.push_back({file, read_model(file)});
    const std::string& units = instruments.back().model.units;
    if (units == problem.units || units.empty()) continue;
    refuse(fmt::format("{}: units = \"{}\": are not those of the implants, \"{}\"", file, units, problem.units));
  }
  return instruments;
}

InstrumentClearance prove_instrument(const FitProblem& problem, const Fit& fit, const Instrument& instrument) {
  return {instrument.file, prove_surface(problem, posed(instrument.model, fit.pose), {})};
}

}  // namespace verisq::command_line
