/// Reads the files that the options name.
#include "host/command_line/fit_request.hpp"

#include <algorithm>
#include <array>
#include <verisq/landmark_file.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

std::optional<FitSurface> surface_named(const FitArguments& arguments) {
  const std::array given{arguments.cavity, arguments.bone, arguments.any_side};
  if (std::ranges::count(given, true) > 1) refuse("give only one of --cavity, --bone and --any-side");
  if (arguments.cavity) return FitSurface::cavity;
  if (arguments.bone) return FitSurface::bone;
  return arguments.any_side ? std::optional(FitSurface::unsided) : std::nullopt;
}

FitLandmarks bone_landmarks(const FitArguments& arguments) {
  const LandmarkFile file = read_landmarks(arguments.landmarks);
  return {arguments.landmarks, file.landmarks, file.side, arguments.landmark_radius};
}

}  // namespace

FitRequest read_fit_request(const FitArguments& arguments) {
  FitRequest request{.implants = {},
                     .mesh_name = arguments.mesh,
                     .mesh = {},
                     .surface = surface_named(arguments),
                     .resection = arguments.resection,
                     .crossing = arguments.crossing,
                     .outside = arguments.outside,
                     .kept = arguments.kept,
                     .objective = arguments.objective,
                     .implant_contact = arguments.implant_contact,
                     .completion = arguments.completion,
                     .gap = arguments.gap,
                     .gap_tolerance = arguments.gap_tolerance,
                     .penetration_limit = arguments.penetration_limit,
                     .pose_start = arguments.pose_start.value_or(Pose{}),
                     .translation_range = arguments.translation_range,
                     .rotation_range = arguments.rotation_range,
                     .seed = arguments.seed,
                     .samples = arguments.samples,
                     .weights = arguments.weights,
                     .device = arguments.device};
  for (const std::string& file : arguments.implants) {
    request.implants.push_back({file, read_uncertain_model(file), read_model_landmarks(file), read_areas(file)});
  }
  if (!arguments.landmarks.empty()) request.landmarks = bone_landmarks(arguments);
  if (arguments.on) request.on_triangles = *arguments.on == MapElements::triangles;
  request.mesh = read_mesh(arguments.mesh);
  if (arguments.labels) request.labelled = read_labelled_cavity(arguments.mesh, *arguments.labels, arguments.weights);
  return request;
}

}  // namespace verisq::command_line
