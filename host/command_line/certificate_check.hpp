/// `verisq check --certificate` of pairs and poses: proves the answer of a certificate file again.
#pragma once

#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// As typed.
struct CertificateCheckArguments {
  std::string certificate;
  std::vector<std::string> models;  ///< in the order of the certificate
  bool json = false;
};

/// Throws Error(input) unless the file, a `what`, is byte for byte the one that the certificate is about.
void refuse_other_file(const std::string& file, const char* what, const SubjectFile& expected,
                       const std::string& certificate);

/// Throws Error(input) unless the units of what is given, `what`, are those that the certificate states.
void refuse_other_units(const std::string& units, const char* what, const std::string& stated,
                        const std::string& certificate);

/// `verified` only when the answer is proved. Throws Error(input) for what the user can correct, also for other models
/// than those that the answer is about. Precondition: of one of these kinds.
ExitStatus run_certificate_check(const Answer& answer, const CertificateCheckArguments& arguments);

}  // namespace verisq::command_line
