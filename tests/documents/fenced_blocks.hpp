/// What stands between the fences of a Markdown file: commands and code.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace verisq::testing {

/// The text of every block that opens with ``` and `language`, in order.
[[nodiscard]] inline std::vector<std::string> fenced_blocks(const std::string& markdown, const std::string& language) {
  std::vector<std::string> blocks;
  std::istringstream lines(markdown);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (inside && line == "```") {
      inside = false;
    } else if (inside) {
      blocks.back() += line + "\n";
    } else if (line == "```" + language) {
      inside = true;
      blocks.emplace_back();
    }
  }
  return blocks;
}

}  // namespace verisq::testing
