/// Names the model's own parts, and the file that they are of.
#include "host/command_line/certified_stance.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <verisq/certificate_file.hpp>
#include <verisq/certified_equilibrium.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

using stance::CertifiedEquilibrium;

CertifiedEquilibrium certified(const StanceSummary& summary, bool no_progress) {
  ProgressBar bar(!no_progress, "%");
  return stance::certified_equilibrium(summary.model, summary.uncertain, summary.control, *summary.equilibrium,
                                       {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                        .interrupted = interrupted,
                                        .progress = [&bar](double done) { bar.update_state("certificates", done); }});
}

}  // namespace

void certify_equilibrium(const std::string& file, StanceSummary& summary, bool no_progress) {
  CertifiedEquilibrium found = certified(summary, no_progress);
  if (found.interrupted) return tell(fmt::format("interrupted; {} is not written", file));
  if (found.left_out > 0) {
    tell(fmt::format(
        "{}: says nothing of {} cells that are found to stand, or of parts of them: the proof that it holds "
        "does not reach there",
        file, found.left_out));
  }
  EquilibriumAnswer answer{.model = subject_file(summary.file),
                           .parameters = {},
                           .joints = joint_names(summary.model),
                           .cylinders = {},
                           .claims = found.claims,
                           .certificate = std::move(found.certificate)};
  for (const std::uint32_t k : summary.uncertain) answer.parameters.push_back(summary.model.parameters[k].name);
  for (const stance::ContactCylinder& cylinder : summary.model.cylinders) answer.cylinders.push_back(cylinder.name);
  write_answer(file, answer);
  summary.certificate = file;
  summary.certified = std::move(found.claims);
}

}  // namespace verisq::command_line
