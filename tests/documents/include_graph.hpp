/// The includes of the project's own sources, as text: what the tests of its structure look at.
#pragma once

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace verisq {

/// As between the quotes or angle brackets, in order. Every include counts, whatever #if surrounds it.
[[nodiscard]] inline std::vector<std::string> includes_of(const std::filesystem::path& file) {
  constexpr std::string_view directive = "#include ";
  std::vector<std::string> names;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(directive)) continue;
    const std::string_view rest = std::string_view(line).substr(directive.size() + 1);
    names.emplace_back(rest.substr(0, rest.find_first_of("\">")));
  }
  return names;
}

/// Where the project keeps what an include names, relative to its root; empty for what is not the project's.
[[nodiscard]] inline std::string own_file(const std::filesystem::path& root, const std::string& name) {
  for (const char* const folder : {"", "include/"}) {
    if (std::filesystem::is_regular_file(root / (folder + name))) return folder + name;
  }
  return {};
}

/// Everything that `files` include, directly or not, they themselves among it, relative to the root; and what of it is
/// not the project's.
struct IncludeClosure {
  std::set<std::string> own;
  std::set<std::string> foreign;
};

[[nodiscard]] inline IncludeClosure include_closure(const std::filesystem::path& root, std::vector<std::string> files) {
  IncludeClosure closure;
  while (!files.empty()) {
    const std::string file = std::move(files.back());
    files.pop_back();
    if (!closure.own.insert(file).second) continue;
    for (const std::string& name : includes_of(root / file)) {
      const std::string own = own_file(root, name);
      if (own.empty()) {
        closure.foreign.insert(name);
      } else {
        files.push_back(own);
      }
    }
  }
  return closure;
}

/// The sources below a folder of the root, relative to the root.
[[nodiscard]] inline std::vector<std::string> sources_below(const std::filesystem::path& root,
                                                            const std::string& folder) {
  std::vector<std::string> sources;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".hpp" || extension == ".cpp" || extension == ".h") {
      sources.push_back(std::filesystem::relative(entry.path(), root).generic_string());
    }
  }
  return sources;
}

}  // namespace verisq
