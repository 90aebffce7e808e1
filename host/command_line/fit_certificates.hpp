/// What a fit leaves for those who prove its distances again: certificates in its maps and its page, and a file of what
/// the distances say together.
#pragma once

#include <optional>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/fit_problem.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/side_checker.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

/// Adds --certificates, --surface-map and --certificate-file.
void declare_certificates(Options& options, FitArguments& arguments);

/// Whether the distances of the vertices get certificates.
[[nodiscard]] bool certifies(const FitArguments& arguments);

/// Throws Error(input) where nothing keeps them, or they would be of another mesh than the file's.
void check_certificates(const FitArguments& arguments);

/// Throws Error(input) for what has no triangles, where their map is asked for.
void refuse_what_has_no_certificates(const FitProblem& problem, const FitArguments& arguments);

/// Of the map of the vertices.
[[nodiscard]] MapContents contents_of(const FitArguments& arguments);

/// Writes the map of whole triangles and the certificate file, where they are asked for. Precondition: the fitted
/// model's file is written. `options`: tolerance and device. Throws Error(failure), and as TriangleMapper.
void write_certificates(const FitProblem& problem, const Model& fitted, const Clearance& clearance,
                        std::vector<SideClaim> sides, const MapOptions& options, const FitArguments& arguments);

/// Writes the certificate of the bound, where it is asked for and not interrupted. Returns the upper end that it
/// proves: hardly more than the bound's.
std::optional<double> write_bound_certificate(const FitProblem& problem, const FitSolution& solution,
                                              const FitArguments& arguments);

}  // namespace verisq::command_line
