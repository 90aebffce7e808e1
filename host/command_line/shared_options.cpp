/// Names and explanations.
#include "host/command_line/shared_options.hpp"

#include <fmt/core.h>

#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/length_option.hpp"

namespace verisq::command_line {

void require_model(Options& options, const std::string& name, std::string& file) {
  options.require(name, file, "FILE", "Model of posed superquadrics (verisq-model/1, JSON)");
}

void add_tolerance(Options& options, std::optional<double>& tolerance, std::string_view owner) {
  options.add("--tol", tolerance, parse_length, "NUMBER",
              fmt::format("Largest width of a verified enclosure, in model units; 0 asks for the tightest.\n"
                          "Default: {} times the radius of {}'s bounding sphere",
                          tolerance_of_distances.text, owner));
}

void add_device(Options& options, std::string& device) {
  options.add("--device", device, "DEVICE", device_explanation);
}

void add_json(Options& options, bool& json) {
  options.add_flag("--json", json, "Print the summary as one JSON object");
}

void add_json_of_enclosures(Options& options, bool& json) {
  options.add_flag("--json", json, "Print the summary as one JSON object; what is not bounded is null");
}

void add_no_progress(Options& options, bool& no_progress) {
  options.add_flag("--no-progress", no_progress, "No progress bar, even on a terminal");
}

}  // namespace verisq::command_line
