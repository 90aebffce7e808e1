/// The option --contact-certificate-file of `verisq fit`: what proves its areas in contact again.
#pragma once

#include <string>
#include <verisq/fit_problem.hpp>
#include <verisq/fit_solution.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

/// Adds it.
void declare_contact_certificate(Options& options, FitArguments& arguments);

/// Throws Error(input) where the mesh is not that of the file, or is no file that a digest can name.
void check_contact_certificate(const FitArguments& arguments);

/// Throws Error(input) for a mesh without triangles, where it is asked for.
void refuse_what_has_no_contact(const FitProblem& problem, const FitArguments& arguments);

/// What became of the file.
enum class ContactFile : std::uint8_t { not_asked_for, written, interrupted, too_large };

/// Writes it where it is asked for, with the areas that the fit found as far as they are proven; of others, and of a
/// file that is not written, tells on the standard error. A Ctrl-C ends it, unless one had come before. Precondition:
/// the fitted model's file is written. Throws Error(failure).
[[nodiscard]] ContactFile write_contact_certificate(const FitProblem& problem, const Fit& fit, const FitProof& proof,
                                                    const FitArguments& arguments);

}  // namespace verisq::command_line
