/// The answers of `distance --poses` with what proves them: the certificate file of many poses.
#pragma once

#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/model.hpp>

namespace verisq::command_line {

/// Encloses the distances at all poses of the file on all processors, as maps on the host do; at most until Ctrl-C,
/// from when on answers are wide. `tolerance` is of those that are searched. Throws as PoseFile.
[[nodiscard]] std::vector<PosedAnswer> certified_distances(const Model& a, const Model& b, const std::string& poses,
                                                           double tolerance, bool show_progress);

}  // namespace verisq::command_line
