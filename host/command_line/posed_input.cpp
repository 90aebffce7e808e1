/// Reads models and moves them.
#include "host/command_line/posed_input.hpp"

#include <fmt/core.h>

#include <verisq/error.hpp>
#include <verisq/model_file.hpp>
#include <verisq/posed_model.hpp>

#include "host/command_line/pose_option.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

template <class AnyModel>
AnyModel moved(const AnyModel& model, const Pose& pose, const std::string& file) {
  try {
    return posed(model, pose);
  } catch (const Error& error) {
    refuse(fmt::format("--pose: {}: {}", file, error.what()));
  }
}

}  // namespace

void add_pose(Options& options, std::optional<Pose>& pose) {
  options.add(
      "--pose", pose, parse_pose, "tx,ty,tz,qw,qx,qy,qz",
      "Moves the model first: x -> R x + t after its primitives' own poses, which are then rounded to binary64\n"
      "(default: where its file has it)");
}

Model read_model_at(const std::optional<Pose>& pose, const std::string& file) {
  const Model model = read_model(file);
  return pose ? moved(model, *pose, file) : model;
}

UncertainModel read_uncertain_model_at(const std::optional<Pose>& pose, const std::string& file) {
  const UncertainModel model = read_uncertain_model(file);
  return pose ? moved(model, *pose, file) : model;
}

}  // namespace verisq::command_line
