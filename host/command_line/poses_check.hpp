/// Proves the answers of a certificate file of many poses again, and says what became of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <verisq/certificate_file.hpp>

#include "host/command_line/certificate_check.hpp"

namespace verisq::command_line {

struct PosesReport {
  /// An answer that is not proved.
  struct Open {
    std::size_t index;
    PosedAnswer answer;
    Finding finding;
  };

  CertificateCheckArguments arguments;
  std::string units;
  std::uint64_t proved = 0;
  std::uint64_t refuted = 0;
  std::uint64_t unproved = 0;
  std::uint64_t unbounded = 0;  ///< that claim nothing from above
  double largest_width = 0.0;   ///< of the proved ones
  std::optional<Open> first{};  ///< refuted; without one, unproved
  double seconds = 0.0;
  bool interrupted = false;
};

/// Precondition: the models are those of the answers.
[[nodiscard]] PosesReport checked_poses(const Model& a, const Model& b, const PoseAnswers& answers,
                                        const CertificateCheckArguments& arguments);

[[nodiscard]] std::string readable(const PosesReport& report);
[[nodiscard]] std::string json(const PosesReport& report);

}  // namespace verisq::command_line
