/// What the rooms of host/ and verify/ include: the trusted ones only each other and what they try; no room a circle.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/documents/include_graph.hpp"
#include "tests/fixtures/places.hpp"

namespace verisq {
namespace {

const std::filesystem::path root = places::source();

/// A reader's one sitting.
constexpr std::size_t most_core_lines = 4000;

/// All that `verisq-check` believes lies here, and nothing else does.
const std::vector<std::string> trusted_rooms{"verify/numbers/", "verify/solids/", "verify/proof/"};

/// The files that prove rows of maps and octrees; for superquadrics, all of them.
const std::vector<std::string> core_sources{
    "verify/numbers/interval.cpp",          "verify/proof/checker.cpp",       "verify/proof/contained_ball.cpp",
    "verify/proof/empty_neighbourhood.cpp", "verify/proof/exact_checker.cpp", "verify/proof/posed_superquadric.cpp",
    "verify/proof/uncertain_model.cpp",     "verify/solids/model.cpp",        "verify/solids/superquadric.cpp",
};

bool is_public(const std::string& file) {
  return file.starts_with("include/verisq/");
}

bool is_in_trusted_room(const std::string& file) {
  return std::ranges::any_of(trusted_rooms, [&](const std::string& room) { return file.starts_with(room); });
}

/// The sources of the CMake target, as it builds them.
std::vector<std::string> sources_of_the_target() {
  std::vector<std::string> sources;
  std::istringstream names(VERISQ_PROOF_SOURCES);
  for (std::string name; std::getline(names, name, ':');) sources.push_back("verify/" + name);
  return sources;
}

std::size_t lines_of(const std::string& file) {
  std::ifstream in(root / file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  return lines;
}

/// A header of the standard library has neither folder nor extension.
bool is_standard(const std::string& name) {
  return name.find_first_of("/.") == std::string::npos;
}

TEST(TrustedRoomsTest, IncludeNothingButEachOtherPublicHeadersAndWhatTheyTry) {
  const IncludeClosure closure = include_closure(root, sources_of_the_target());
  ASSERT_GT(closure.own.size(), 60U);
  for (const std::string& file : closure.own) {
    const bool is_suggestion = file.starts_with("verify/proposals/");
    EXPECT_TRUE(is_in_trusted_room(file) || is_public(file) || is_suggestion) << file;
  }
  for (const std::string& name : closure.foreign) {
    EXPECT_TRUE(is_standard(name) || name == "mpfr.h" || name == "fmt/format.h" || name.starts_with("boost/") ||
                name.starts_with("Eigen/"))
        << name;
  }
}

TEST(TrustedRoomsTest, AreAllOfTheTarget) {
  const IncludeClosure closure = include_closure(root, sources_of_the_target());
  std::size_t lines = 0;
  for (const std::string& room : trusted_rooms) {
    for (const std::string& file : sources_below(root, room)) {
      EXPECT_TRUE(closure.own.contains(file)) << file;
      lines += lines_of(file);
    }
  }
  std::cout << "lines of the trusted rooms: " << lines << "\n";
}

TEST(TrustedCoreTest, IncludesNothingButTrustedRoomsPublicHeadersMpfrAndBoost) {
  const IncludeClosure closure = include_closure(root, core_sources);
  ASSERT_GT(closure.own.size(), 20U);
  for (const std::string& file : closure.own) EXPECT_TRUE(is_in_trusted_room(file) || is_public(file)) << file;
  for (const std::string& name : closure.foreign) {
    EXPECT_TRUE(is_standard(name) || name == "mpfr.h" || name.starts_with("boost/")) << name;
  }
}

TEST(TrustedCoreTest, CanBeReadInOneSitting) {
  std::size_t lines = 0;
  for (const std::string& file : include_closure(root, core_sources).own) lines += lines_of(file);
  std::cout << "lines to trust for maps and octrees: " << lines << "\n";
  EXPECT_LE(lines, most_core_lines);
}

/// The rooms that each one includes from, with an include as an example.
using Arrows = std::map<std::string, std::map<std::string, std::string>>;

const std::vector<std::string> houses{"host", "verify"};

/// A room is a folder of host/ or verify/. Public headers belong to none: they hold what all rooms speak of. That no
/// room below calls one above, the linker knows: verisq-check is linked with verify/ and the readers alone.
class Rooms {
 public:
  Rooms() {
    for (const std::string& house : houses) {
      for (const std::string& file : sources_below(root, house)) {
        rooms_[file] = std::filesystem::path(file).parent_path().generic_string();
      }
    }
  }

  /// Those that pass through headers of no room count as well.
  [[nodiscard]] Arrows arrows() const {
    Arrows result;
    for (const auto& [file, room] : rooms_) {
      std::vector<std::string> open{file};
      std::set<std::string> seen;
      while (!open.empty()) {
        const std::string at = open.back();
        open.pop_back();
        for (const std::string& name : includes_of(root / at)) {
          const std::string included = own_file(root, name);
          if (included.empty() || !seen.insert(included).second) continue;
          const auto found = rooms_.find(included);
          if (found == rooms_.end()) {
            open.push_back(included);
          } else if (found->second != room) {
            result[room].try_emplace(found->second, fmt::format("{} includes {}", file, included));
          }
        }
      }
    }
    return result;
  }

 private:
  std::map<std::string, std::string> rooms_;
};

/// Sources that are compiled as one: the batches of verify/CMakeLists.txt.
std::vector<std::vector<std::string>> batches_of_search() {
  std::vector<std::vector<std::string>> batches;
  std::ifstream in(root / "verify/CMakeLists.txt");
  bool is_open = false;
  for (std::string word; in >> word;) {
    if (word == "BATCH" || word == ")") is_open = word == "BATCH";
    if (word == "BATCH") {
      batches.emplace_back();
    } else if (is_open && word.ends_with(".cpp")) {
      batches.back().push_back("verify/" + word);
    }
  }
  return batches;
}

/// A source as text without comments, and the functions of its unnamed namespaces, which begin their lines.
struct BatchedSource {
  std::string file;
  std::string code;
  std::set<std::string> private_functions;
  bool has_using_directive = false;  ///< outside of functions
};

BatchedSource read_source(const std::string& file) {
  static const std::regex declaration(R"(^[A-Za-z_\[][^=(]*[\w>&*\]] ?[&*]*\b(\w+)\(.*)");
  BatchedSource source{.file = file, .code = {}, .private_functions = {}};
  std::ifstream in(root / file);
  bool is_private = false;
  for (std::string line; std::getline(in, line);) {
    if (line == "namespace {") is_private = true;
    if (line == "}  // namespace") is_private = false;
    std::smatch match;
    if (is_private && std::regex_match(line, match, declaration)) source.private_functions.insert(match[1]);
    source.has_using_directive = source.has_using_directive || line.starts_with("using namespace");
    source.code += line.substr(0, line.find("//")) + "\n";
  }
  return source;
}

std::vector<BatchedSource> read_batch(const std::vector<std::string>& files) {
  std::vector<BatchedSource> sources;
  sources.reserve(files.size());
  for (const std::string& file : files) sources.push_back(read_source(file));
  return sources;
}

/// A call of a function that two files have would choose one of them: perhaps the other file's.
TEST(BatchesTest, CallNoPrivateFunctionOfEachOther) {
  const auto batches = batches_of_search();
  ASSERT_GT(batches.size(), 5U);
  std::size_t functions = 0;
  for (const std::vector<std::string>& files : batches) {
    const std::vector<BatchedSource> batch = read_batch(files);
    ASSERT_GT(batch.size(), 1U);
    for (const BatchedSource& source : batch) {
      functions += source.private_functions.size();
      for (const std::string& name : source.private_functions) {
        const std::regex call("(^|[^\\w.>:~])" + name + "\\(");
        for (const BatchedSource& other : batch) {
          if (&other == &source) continue;
          EXPECT_FALSE(std::regex_search(other.code, call)) << other.file << " and " << source.file << ": " << name;
        }
      }
    }
  }
  EXPECT_GT(functions, 100U);
}

/// It would hold for the sources that follow.
TEST(BatchesTest, HaveUsingDirectivesInTheirLastSourceAlone) {
  std::size_t directives = 0;
  for (const std::vector<std::string>& files : batches_of_search()) {
    const std::vector<BatchedSource> batch = read_batch(files);
    for (const BatchedSource& source : batch) {
      directives += source.has_using_directive ? 1 : 0;
      EXPECT_TRUE(!source.has_using_directive || &source == &batch.back()) << source.file;
    }
  }
  EXPECT_GT(directives, 0U);
}

TEST(RoomsTest, HoldEveryFile) {
  for (const std::string& house : houses) {
    for (const std::string& file : sources_below(root, house)) {
      EXPECT_NE(std::filesystem::path(file).parent_path(), house) << file;
    }
  }
}

/// Whether a way along the arrows leads from one room to the other.
bool leads_to(const Arrows& arrows, const std::string& from, const std::string& to) {
  std::vector<std::string> open{from};
  std::set<std::string> seen;
  while (!open.empty()) {
    const std::string room = open.back();
    open.pop_back();
    if (room == to) return true;
    const auto found = arrows.find(room);
    if (!seen.insert(room).second || found == arrows.end()) continue;
    for (const auto& [target, example] : found->second) open.push_back(target);
  }
  return false;
}

TEST(RoomsTest, NoneIncludesWhatIncludesIt) {
  const Arrows arrows = Rooms().arrows();
  ASSERT_TRUE(leads_to(arrows, "verify/proof", "verify/numbers"));
  ASSERT_FALSE(leads_to(arrows, "verify/proposals", "verify/proof"));
  ASSERT_TRUE(leads_to(arrows, "host/maps", "verify/proof"));
  for (const auto& [room, targets] : arrows) {
    for (const auto& [target, example] : targets) {
      EXPECT_FALSE(leads_to(arrows, target, room)) << room << " and " << target << ": " << example;
    }
  }
}

TEST(PythonTest, IncludesNothingOfTheProjectButItselfAndPublicHeaders) {
  std::size_t headers = 0;
  for (const std::string& file : sources_below(root, "python")) {
    for (const std::string& name : includes_of(root / file)) {
      const std::string included = own_file(root, name);
      if (is_public(included)) ++headers;
      EXPECT_TRUE(included.empty() || is_public(included) || included.starts_with("python/"))
          << file << " includes " << name;
    }
  }
  EXPECT_GT(headers, 20U);
}

}  // namespace
}  // namespace verisq
