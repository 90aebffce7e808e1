/// `verisq check`, which is also the program `verisq-check`: proves a finished map again from the model, the points or
/// triangles, and the certificates, the answer of a certificate file, or an octree, without OpenCL.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/point_stream.hpp"

namespace verisq::command_line {

/// As typed.
struct CheckArguments {
  std::vector<std::string> models;  ///< of a map one, of a certificate those that it is about, in its order
  InputArguments inputs;            ///< all but the model
  // One of these, or a map with the certificate of a fit.
  std::string map;
  std::string certificate;
  std::string octree;
  std::string poses;                    ///< that a certificate is to be of; empty: any
  std::string within;                   ///< the bone's outer surface of a way in along a cavity; empty: none
  std::string surface_map;              ///< of the fit, of whole triangles
  std::optional<std::uint64_t> sample;  ///< of the octree, how many cubes; nothing: all
  double point_radius = 0.0;
  bool json = false;
  bool no_progress = false;
};

void declare_check(Options& options, CheckArguments& arguments);

/// `verified` only when every enclosure is proved. Throws Error(input) for what the user can correct, also for a map
/// that has not one row for each point or triangle.
ExitStatus run_check(const CheckArguments& given);

}  // namespace verisq::command_line
