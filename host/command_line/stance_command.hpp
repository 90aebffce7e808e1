/// `verisq stance`: enclosures of wrench, sensitivities and accelerations of a stance model with uncertain parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/stance/stance_results.hpp"

namespace verisq::command_line {

// The output of `verisq stance`: for people, or as one JSON object.

/// Absent members were not requested.
struct StanceSummary {
  std::string file;
  stance::Model model;
  std::vector<std::uint32_t> uncertain;
  stance::Mode mode = stance::Mode::tight;
  stance::AccelerationCase acceleration_case = stance::AccelerationCase::fall;
  std::optional<stance::WrenchEnclosure> wrench;
  stance::Scope wrench_scope;
  std::optional<stance::Samples> wrench_samples;
  std::vector<stance::WrenchEnclosure> sensitivities;  ///< by every parameter of the model; or empty
  std::optional<stance::ReferenceUncertainty> reference;
  std::vector<Enclosure> accelerations;          ///< of all joints, bodies in order; or empty
  std::vector<stance::JointPosition> elsewhere;  ///< joints that the accelerations have in other places than the file
  stance::Scope acceleration_scope;
  std::optional<stance::Samples> acceleration_samples;
  stance::JointControl control = stance::JointControl::held;
  std::optional<stance::Equilibrium> equilibrium;
  stance::Scope equilibrium_scope;
  std::string certificate;                             ///< its file
  std::optional<stance::EquilibriumClaims> certified;  ///< the claims that it proves
  stance::JointControl stability_control = stance::JointControl::held;
  std::optional<stance::Stability> stability;
  stance::Scope stability_scope;
  std::optional<stance::Motion> motion;
  double motion_duration = 0.0;  ///< requested duration, s
  stance::Scope motion_scope;
  std::optional<stance::PaperReport> paper;
  std::string dropped;  ///< the cylinder that bounces
  std::optional<stance::Drop> drop;
  std::optional<stance::Bounce> bounce;
  stance::Scope bounce_scope;
  double seconds = 0.0;
  bool interrupted = false;
};

/// "w1" ... "w6".
[[nodiscard]] std::string component_name(std::size_t component);

/// Properties that the model may have and a reader should know: dynamic friction above static friction.
[[nodiscard]] std::vector<std::string> notes(const stance::Model& model);

/// Ends of enclosures are rounded outward to the digits printed.
[[nodiscard]] std::string readable(const StanceSummary& summary);

/// An infinite end is null.
[[nodiscard]] JsonObject json_value(const StanceSummary& summary);

/// The same as one line.
[[nodiscard]] std::string json(const StanceSummary& summary);

// The page of `verisq stance --report FILE.html`: equilibrium, stability and motion for people to look at.

/// The page's data (report/README.md) as one line of JSON: the output of --json, and the points of the drawn body.
[[nodiscard]] std::string stance_page_data(const StanceSummary& summary);

/// Throws Error(failure).
void write_stance_page(const std::string& file, const StanceSummary& summary);

// `verisq stance --certificate-file`: the found equilibrium with its proof.

/// Certifies the summary's equilibrium, and adds the claims that the file proves to it. Once interrupted it reports
/// that instead, and writes no file.
void certify_equilibrium(const std::string& file, StanceSummary& summary, bool no_progress);

/// As typed; `run_stance` checks what depends on the file or on several options.
struct StanceArguments {
  std::string model;
  std::optional<std::string> uncertain;
  std::vector<NamedRange> ranges;  ///< instead of the file's
  std::optional<double> within;    ///< per cent of the nominal value, of every uncertain parameter
  std::optional<stance::Mode> mode;
  bool sensitivities = false;
  OptionalText accelerations;       ///< the case, fall where empty
  std::vector<NamedNumber> joints;  ///< other positions than the file's
  std::optional<stance::JointControl> equilibrium;
  std::optional<stance::JointControl> stability;
  std::string parameter_map;     ///< file; or empty
  std::string certificate_file;  ///< likewise
  std::optional<std::uint32_t> cells;
  std::optional<double> simulate;  ///< in s
  std::optional<double> lift;      ///< in m
  std::optional<double> drop;      ///< in m
  std::optional<stance::Push> push;
  std::string csv, plot;
  std::optional<std::uint64_t> monte_carlo;
  OptionalText report;
  std::optional<std::string> bounce;
  std::optional<double> drop_height;  ///< in m
  bool json = false;
  bool no_progress = false;
};

void declare_stance(Options& options, StanceArguments& arguments);

/// Throws Error(input) for whatever the user can correct, Error(failure) where a sample escapes from an enclosure.
ExitStatus run_stance(const StanceArguments& arguments);

}  // namespace verisq::command_line
