/// The documents agree with the tree: links and names of files lead somewhere, public headers to their sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/documents/include_graph.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/process.hpp"

namespace verisq::testing {
namespace {

using std::filesystem::path;

const path root = places::source();

/// Of the working tree without what is built or fetched, relative to the root.
std::vector<path> files() {
  const std::set<std::string> left_out{".git", "build", "node_modules"};
  std::vector<path> result;
  for (auto entry = std::filesystem::recursive_directory_iterator(root);
       entry != std::filesystem::recursive_directory_iterator(); ++entry) {
    if (left_out.contains(entry->path().filename().string())) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file()) {
      result.push_back(entry->path().lexically_relative(root));
    }
  }
  return result;
}

std::vector<path> documents() {
  std::vector<path> result = files();
  std::erase_if(result, [](const path& file) { return file.extension() != ".md"; });
  return result;
}

/// Without what stands between fences.
std::vector<std::string> prose_of(const path& document) {
  std::vector<std::string> prose;
  std::istringstream lines(contents(root / document));
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) fenced = !fenced;
    if (!fenced) prose.push_back(line);
  }
  return prose;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern); match != std::sregex_iterator(); ++match) {
    found.push_back((*match)[1]);
  }
  return found;
}

/// As GitHub names a heading: small letters, blanks as hyphens, no punctuation.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char character : heading) {
    const auto byte = static_cast<unsigned char>(character);
    if (std::isalnum(byte) != 0 || character == '-' || character == '_') {
      anchor += static_cast<char>(std::tolower(byte));
    } else if (character == ' ') {
      anchor += '-';
    }
  }
  // The sign of a section and the blank after it: the sign goes, and with it what would be a leading hyphen.
  return anchor.starts_with("-") ? anchor.substr(1) : anchor;
}

std::set<std::string> anchors_of(const path& document) {
  std::set<std::string> anchors;
  for (const std::string& line : prose_of(document)) {
    if (line.starts_with("#")) anchors.insert(anchor_of(line.substr(line.find_first_not_of("# "))));
  }
  return anchors;
}

TEST(Documents, LinkToFilesAndHeadingsThatAreThere) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::size_t links = 0;
  for (const path& document : documents()) {
    for (const std::string& target : matches(joined(prose_of(document)), link)) {
      if (target.find("://") != std::string::npos) continue;
      ++links;
      const std::size_t hash = target.find('#');
      const path file = hash == 0 ? document : (document.parent_path() / target.substr(0, hash)).lexically_normal();
      EXPECT_TRUE(std::filesystem::exists(root / file)) << document << " links to " << target;
      if (hash == std::string::npos || !std::filesystem::exists(root / file)) continue;
      EXPECT_TRUE(anchors_of(file).contains(target.substr(hash + 1))) << document << " links to " << target;
    }
  }
  EXPECT_GT(links, 200U);
}

// A name in backquotes: a path from the root, or its end.
TEST(Documents, NameSourcesThatAreThere) {
  static const std::regex name(R"(`([a-z0-9_./]+\.(?:cpp|hpp|cl|clh|cmake|gappa|sollya|py|mjs|supp)))"
                               "`");
  std::vector<std::string> known;
  for (const path& file : files()) known.push_back((path("/") / file).generic_string());
  std::size_t names = 0;
  for (const path& document : documents()) {
    for (const std::string& source : matches(joined(prose_of(document)), name)) {
      ++names;
      const std::string end = (path("/") / source).generic_string();
      const bool there = std::ranges::any_of(known, [&](const std::string& file) { return file.ends_with(end); });
      EXPECT_TRUE(there) << document << " names " << source;
    }
  }
  EXPECT_GT(names, 50U);
}

/// The rows `| [name.hpp](…) | [name.cpp](…), … |` of docs/architecture.md, paths from the root; of declarations alone
/// the sources are none.
std::map<std::string, std::vector<std::string>> sources_of_headers() {
  static const std::regex target(R"(\]\(\.\./([^)]+)\))");
  std::map<std::string, std::vector<std::string>> result;
  for (const std::string& line : prose_of("docs/architecture.md")) {
    if (!line.starts_with("| [") || line.find("](../include/verisq/") == std::string::npos) continue;
    std::vector<std::string> paths = matches(line, target);
    const std::string header = paths.front();
    if (!header.ends_with(".hpp") && !header.ends_with(".h")) continue;  // the folder itself
    paths.erase(paths.begin());
    if (paths.empty()) {
      EXPECT_NE(line.find("| no source |"), std::string::npos) << line;
    }
    EXPECT_TRUE(result.emplace(header, paths).second) << header << " twice";
  }
  return result;
}

TEST(Documents, SayWhereEachPublicHeaderIsImplemented) {
  const auto told = sources_of_headers();
  const std::vector<std::string> headers = sources_below(root, "include/verisq");
  EXPECT_EQ(told.size(), headers.size());
  for (const std::string& header : headers) EXPECT_TRUE(told.contains(header)) << header;
  for (const auto& [header, sources] : told) {
    EXPECT_TRUE(std::filesystem::exists(root / header)) << header;
    for (const std::string& source : sources) {
      EXPECT_TRUE(include_closure(root, {source}).own.contains(header)) << source << " does not include " << header;
    }
  }
}

TEST(Documents, OneHeaderIncludesAllOfTheLibrary) {
  const std::string all = "include/verisq/verisq.hpp";
  const std::string of_surface = "include/verisq/surface.hpp";
  std::set<std::string> wanted;
  for (const std::string& header : sources_below(root, "include/verisq")) {
    if (header.ends_with(".hpp") && header != all && header != of_surface) wanted.insert(header);
  }
  std::set<std::string> included;
  for (const std::string& name : includes_of(root / all)) included.insert("include/" + name);
  EXPECT_EQ(included, wanted);
}

/// Functions without a body, of classes too; what begins with a keyword of control is a statement in a body.
bool declares_functions(const std::string& header) {
  static const std::regex end_of_declaration(R"(\)( const)?( noexcept)?;(\s*//.*)?$)");
  static const std::regex statement_or_comment(R"(^\s*(//|(for|friend|if|return|inline constexpr)\b))");
  std::istringstream lines(contents(root / header));
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, end_of_declaration) && !std::regex_search(line, statement_or_comment)) return true;
  }
  return false;
}

TEST(Documents, SayNoSourceOfHeadersThatDeclareNoFunction) {
  for (const auto& [header, sources] : sources_of_headers())
    EXPECT_EQ(declares_functions(header), !sources.empty()) << header;
}

}  // namespace
}  // namespace verisq::testing
