/// Proves once more what the fit found, and claims as much of it as that says.
#include "host/command_line/contact_certificate.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/certified_contact.hpp>
#include <verisq/error.hpp>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

/// Roundings alone make a claim wider by less.
constexpr double share_of_roundings = 1e-9;

void tell_if_wider(const std::string& file, const std::string& name, const AreaWithin& found,
                   const ContactClaim& claimed) {
  constexpr int digits = 4;
  const Enclosure of_found = claim_of(found).percent;
  if (claimed.percent.width() <= of_found.width() * (1.0 + share_of_roundings)) return;
  tell(fmt::format("{}: claims less of {} than was found: {} %, not {} %", file, name,
                   outward_digits(claimed.percent, digits), outward_digits(of_found, digits)));
}

void tell_of_wider(const std::string& file, const ContactAreas& found, const ContactClaims& claimed,
                   const std::vector<std::string>& names) {
  tell_if_wider(file, "contact", found.of_mesh, claimed.of_mesh);
  for (std::size_t k = 0; k < names.size(); ++k)
    tell_if_wider(file, "contact:" + names[k], found.by_region[k], claimed.by_region[k]);
  if (found.of_model && claimed.of_model) tell_if_wider(file, "implant_contact", *found.of_model, *claimed.of_model);
}

}  // namespace

void declare_contact_certificate(Options& options, FitArguments& arguments) {
  options.add(
      "--contact-certificate-file", arguments.contact_certificate, "FILE",
      "How much of the mesh's area, of each area's and, with --implant-contact, of the implant's own surface is "
      "in contact, with what proves it again, for `verisq check --certificate` with the fitted model and the "
      "mesh: .json");
}

void check_contact_certificate(const FitArguments& arguments) {
  if (arguments.contact_certificate.empty()) return;
  if (arguments.resection)
    refuse("--contact-certificate-file: not with --resection, which leaves a part of the mesh out: cut it first");
  if (!std::filesystem::is_regular_file(arguments.mesh))
    refuse(fmt::format("--contact-certificate-file: {}: is no regular file, and it must tell which it is",
                       arguments.mesh));
}

void refuse_what_has_no_contact(const FitProblem& problem, const FitArguments& arguments) {
  if (!arguments.contact_certificate.empty() && problem.mesh.triangles.empty())
    refuse(fmt::format("--contact-certificate-file: {}: has no triangles", arguments.mesh));
}

ContactFile write_contact_certificate(const FitProblem& problem, const Fit& fit, const FitProof& proof,
                                      const FitArguments& arguments) {
  const std::string& file = arguments.contact_certificate;
  if (file.empty()) return ContactFile::not_asked_for;
  // The first Ctrl-C may have ended the search: what it found is proven all the same.
  const auto ended = [before = interrupted()] { return !before && interrupted(); };
  CertifiedContact certified;
  {
    ProgressBar bar(!arguments.no_progress, "%");
    certified = certified_contact(problem, fit, proof, ended,
                                  [&bar](double done) { bar.update_state("certificate of contact", done); });
  }
  if (certified.proven.interrupted) {
    tell(fmt::format("interrupted; {} is not written", file));
    return ContactFile::interrupted;
  }
  ContactAnswer answer{.model = subject_file(arguments.output),
                       .mesh = subject_file(arguments.mesh),
                       .units = problem.units,
                       .distance = certified.terms.distance,
                       .regions = {},
                       .region_runs = runs_of(certified.terms.region_of),
                       .claims = std::move(certified.claims),
                       .counted = std::move(certified.terms.counted),
                       .certificate = std::move(certified.certificate)};
  for (const Area& area : problem.cavity.areas) answer.regions.push_back(area.name);
  try {
    write_answer(file, answer);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    tell(error.what());
    return ContactFile::too_large;
  }
  tell_of_wider(file, *proof.contact, answer.claims, answer.regions);
  return ContactFile::written;
}

}  // namespace verisq::command_line
