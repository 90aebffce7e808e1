/// What `verisq stance` prints: for people, or as one JSON object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/equilibrium_claims.hpp>
#include <verisq/stance_bounce.hpp>
#include <verisq/stance_choice.hpp>
#include <verisq/stance_equilibrium.hpp>
#include <verisq/stance_motion.hpp>
#include <verisq/stance_stability.hpp>

#include "host/command_line/json_value.hpp"
#include "host/stance/stance_report.hpp"
#include "host/stance/stance_samples.hpp"
#include "host/stance/stance_scope.hpp"

namespace verisq::command_line {

/// What is absent was not asked for.
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
  std::optional<stance::EquilibriumClaims> certified;  ///< what that proves
  stance::JointControl stability_control = stance::JointControl::held;
  std::optional<stance::Stability> stability;
  stance::Scope stability_scope;
  std::optional<stance::Motion> motion;
  double motion_duration = 0.0;  ///< that was asked for, s
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

/// What the model allows and a reader should know: dynamic friction above static friction.
[[nodiscard]] std::vector<std::string> notes(const stance::Model& model);

/// Ends of enclosures are rounded outward to the digits printed.
[[nodiscard]] std::string readable(const StanceSummary& summary);

/// An infinite end is null.
[[nodiscard]] JsonObject json_value(const StanceSummary& summary);

/// The same as one line.
[[nodiscard]] std::string json(const StanceSummary& summary);

}  // namespace verisq::command_line
