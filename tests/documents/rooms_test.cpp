/// What the rooms of host/ and verify/ include: the trusted ones nothing but each other, none of them in a circle.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
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
constexpr std::size_t most_trusted_lines = 4000;

/// What the answers and their certificates are stated in.
const std::set<std::string> trusted_headers{
    "include/verisq/certificate.hpp",     "include/verisq/checker.hpp",     "include/verisq/enclosure.hpp",
    "include/verisq/error.hpp",           "include/verisq/mesh.hpp",        "include/verisq/model.hpp",
    "include/verisq/octree_checker.hpp",  "include/verisq/octree_cube.hpp", "include/verisq/pair_certificate.hpp",
    "include/verisq/uncertain_model.hpp",
};

bool is_in_trusted_room(const std::string& file) {
  return file.starts_with("verify/numbers/") || file.starts_with("verify/proof/");
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

TEST(TrustedCoreTest, IncludesNothingButItsRoomsItsHeadersMpfrAndBoost) {
  const IncludeClosure closure = include_closure(root, sources_of_the_target());
  ASSERT_GT(closure.own.size(), 30U);
  for (const std::string& file : closure.own) {
    EXPECT_TRUE(is_in_trusted_room(file) || trusted_headers.contains(file)) << file;
  }
  for (const std::string& name : closure.foreign) {
    EXPECT_TRUE(is_standard(name) || name == "mpfr.h" || name.starts_with("boost/")) << name;
  }
  for (const std::string& header : trusted_headers) EXPECT_TRUE(closure.own.contains(header)) << header;
}

TEST(TrustedCoreTest, IsAllOfItsRooms) {
  const IncludeClosure closure = include_closure(root, sources_of_the_target());
  for (const char* const room : {"verify/numbers", "verify/proof"}) {
    for (const std::string& file : sources_below(root, room)) EXPECT_TRUE(closure.own.contains(file)) << file;
  }
}

TEST(TrustedCoreTest, CanBeReadInOneSitting) {
  std::size_t lines = 0;
  for (const std::string& file : include_closure(root, sources_of_the_target()).own) lines += lines_of(file);
  std::cout << "lines to trust: " << lines << "\n";
  EXPECT_LE(lines, most_trusted_lines);
}

/// The rooms that each one includes from, with an include as an example.
using Arrows = std::map<std::string, std::map<std::string, std::string>>;

const std::vector<std::string> houses{"host", "verify"};

/// A room is a folder of host/ or verify/. The public header whose implementation is there is of that room, too; other
/// public headers belong to none.
class Rooms {
 public:
  Rooms() {
    for (const std::string& house : houses) {
      for (const std::string& file : sources_below(root, house)) {
        const std::filesystem::path path = file;
        const std::string room = path.parent_path().generic_string();
        rooms_[file] = room;
        const std::string header = "include/verisq/" + path.stem().string() + ".hpp";
        if (path.extension() == ".cpp" && includes(file, header)) rooms_[header] = room;
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
  static bool includes(const std::string& file, const std::string& header) {
    const std::vector<std::string> names = includes_of(root / file);
    return std::ranges::any_of(names, [&](const std::string& name) { return own_file(root, name) == header; });
  }

  std::map<std::string, std::string> rooms_;
};

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
      const bool is_public = included.starts_with("include/verisq/");
      if (is_public) ++headers;
      EXPECT_TRUE(included.empty() || is_public || included.starts_with("python/")) << file << " includes " << name;
    }
  }
  EXPECT_GT(headers, 20U);
}

}  // namespace
}  // namespace verisq
