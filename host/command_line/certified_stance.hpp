/// `verisq stance --certificate-file`: the equilibrium that was found, with what proves it again.
#pragma once

#include <string>

#include "host/command_line/stance_summary.hpp"

namespace verisq::command_line {

/// Of the summary's equilibrium; adds what the file proves to it. Once interrupted it says so instead, and writes none.
void certify_equilibrium(const std::string& file, StanceSummary& summary, bool no_progress);

}  // namespace verisq::command_line
