/// Runs the search of verisq/deviation.hpp to its usual tolerance.
#include "host/command_line/proven_deviation.hpp"

#include "host/command_line/interruption.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {

Deviation proven_deviation(const Model& model, const Mesh& mesh, const ProofArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "points");
  DeviationOptions options;
  options.percentiles = proven_percentiles;
  options.statistics_of_surface = arguments.statistics;
  options.device = arguments.device;
  options.interrupted = interrupted;
  options.progress = [&bar](std::string_view stage, double done) { bar.update_state(stage, done); };
  return deviation(model, mesh, options);
}

}  // namespace verisq::command_line
