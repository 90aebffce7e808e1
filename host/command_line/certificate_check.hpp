/// `verisq check --certificate` of pairs and poses: proves the answer of a certificate file again.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// As typed.
struct CertificateCheckArguments {
  std::string certificate;
  std::vector<std::string> models;  ///< in the order of the certificate
  std::string poses;                ///< a file whose poses those of the certificate have to be; empty: any
  bool json = false;
};

/// A and B.
using TwoModels = std::array<Model, 2>;

/// Those that are given. Throws Error(input) unless they are the ones that the answer is about, in the units that it
/// states.
[[nodiscard]] TwoModels models_of(const std::array<SubjectFile, 2>& subjects, const std::string& stated_units,
                                  const CertificateCheckArguments& arguments);

/// Throws Error(input) unless the file, a `what`, is byte for byte the one that the certificate is about.
void refuse_other_file(const std::string& file, const char* what, const SubjectFile& expected,
                       const std::string& certificate);

/// Throws Error(input) unless the file, if one is given, holds these poses in this order.
void refuse_other_poses(const std::string& file, std::span<const Pose> poses, const std::string& certificate);

/// Whether it is what the user meant, after that: a line that says who has to see to it. A `way`, or a path.
[[nodiscard]] std::string meant_in_words(const std::string& file, std::string_view way);

/// Throws Error(input) unless the units of what is given, `what`, are those that the certificate states.
void refuse_other_units(const std::string& units, const char* what, const std::string& stated,
                        const std::string& certificate);

/// `verified` only when the answer is proved. Throws Error(input) for what the user can correct, also for other models
/// than those that the answer is about. Precondition: of one of these kinds.
ExitStatus run_certificate_check(const Answer& answer, const CertificateCheckArguments& arguments);

}  // namespace verisq::command_line
