/// The commands that the documents show work as printed. The tutorial's print the lines beside them, a fit finds its
/// known answer, and the code is that of the examples. VERISQ_FEMUR: the femur of the demo, where it is not
/// build/demo/femur.off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "tests/documents/fenced_blocks.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path root = places::source();

std::string commands_document() {
  return contents(root / "docs" / "commands.md");
}

/// The lines of the shell blocks that start one of the programs; a backslash joins a line to the next.
std::vector<std::string> commands_in(const std::string& document) {
  std::vector<std::string> result;
  for (const std::string& block : fenced_blocks(document, "sh")) {
    std::istringstream lines(std::regex_replace(block, std::regex(R"(\\\n)"), ""));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("build/release/")) result.push_back(line);
    }
  }
  return result;
}

std::string command_with(const std::string& words) {
  for (const std::string& command : commands_in(commands_document())) {
    if (command.find(words) != std::string::npos) return command;
  }
  ADD_FAILURE() << "commands.md has no command with " << words;
  return "false";
}

/// The numbers of the one line that starts with `label`.
std::vector<double> numbers_after(const std::string& label, const std::string& summary) {
  std::smatch line;
  if (!std::regex_search(summary, line, std::regex("(?:^|\n)" + label + "  +([^\n]*)"))) return {};
  const std::string text = line[1];
  static const std::regex number(R"([-+]?\d+\.?\d*(?:e[-+]?\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator match(text.begin(), text.end(), number); match != std::sregex_iterator(); ++match) {
    numbers.push_back(std::stod(match->str()));
  }
  return numbers;
}

/// A folder that looks as its reader's does: the built programs, the examples, and the bone of the demo.
class ShownCommands : public ProgramTest {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = folder_.path();
    std::filesystem::create_directories(folder / "build" / "demo");
    std::filesystem::create_directory_symlink(std::filesystem::path(places::program()).parent_path(),
                                              folder / "build" / "release");
    std::filesystem::create_directory_symlink(places::source() + "/examples", folder / "examples");
  }

  /// Without the network a cavity around the same implant stands in for the femur.
  void add_bone() const {
    const std::filesystem::path bone = folder_.path() / "build" / "demo" / "femur.off";
    const char* const given = std::getenv("VERISQ_FEMUR");
    const std::filesystem::path fetched = given != nullptr ? given : root / "build" / "demo" / "femur.off";
    if (given != nullptr || std::filesystem::exists(fetched)) {
      std::filesystem::copy_file(fetched, bone);
      return;
    }
    const std::string stem = places::example("stem.json");
    ASSERT_EQ(Process({places::cavity_generator(), stem, "0.05", bone.string()}, folder_.path()).wait().status, 0);
  }

  [[nodiscard]] Outcome as_printed(const std::string& command) const {
    return Process({"/bin/sh", "-c", "cd '" + folder_.path().string() + "' && " + command}, folder_.path()).wait();
  }
};

TEST_F(ShownCommands, CommandsWorkAsPrinted) {
  add_bone();
  const std::vector<std::string> all = commands_in(commands_document());
  EXPECT_GE(all.size(), 9U);
  for (const std::string& command : all) {
    const Outcome outcome = as_printed(command);
    if (!VERISQ_HAS_SURFACE && command.starts_with("build/release/verisq surface")) {
      EXPECT_EQ(outcome.status, 2) << command;
      EXPECT_THAT(outcome.err, HasSubstr("CGAL"));
    } else {
      EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.err;  // none is shown that stays wide
    }
  }
}

TEST_F(ShownCommands, CommandsAreAllShownButOneOfDevices) {
  const std::string text = commands_document();
  static const std::regex row(R"(\n\| `([a-z]+)` \| )");
  std::size_t rows = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), row); match != std::sregex_iterator(); ++match) {
    const std::string name = (*match)[1];
    ++rows;
    if (name == "devices") continue;
    command_with(name == "check" ? "verisq-check " : "verisq " + name + " ");
  }
  EXPECT_EQ(rows, 16U);
}

// F has 1 for each vertex at the gap, and all are where the implant's file places it: no pose is better.
TEST_F(ShownCommands, FitFindsTheKnownAnswer) {
  constexpr double points = 786.0;
  const Outcome outcome = as_printed(command_with(" fit "));
  ASSERT_EQ(outcome.status, 0) << outcome.err;

  const std::vector<double> objective = numbers_after("objective", outcome.out);
  ASSERT_EQ(objective.size(), 3U) << outcome.out;
  EXPECT_LE(objective[0], points);
  EXPECT_GT(objective[0], points - 1e-6);
  EXPECT_GE(objective[1], objective[0]);
  EXPECT_EQ(objective[2], points);

  const std::vector<double> translation = numbers_after("translation", outcome.out);
  ASSERT_EQ(translation.size(), 3U) << outcome.out;
  for (const double component : translation) EXPECT_NEAR(component, 0.0, 1e-5);
  const std::vector<double> quaternion = numbers_after("quaternion", outcome.out);
  ASSERT_EQ(quaternion.size(), 4U) << outcome.out;
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(quaternion[k], k == 0 ? 1.0 : 0.0, 1e-6);

  const std::vector<double> smallest = numbers_after("smallest distance", outcome.out);
  ASSERT_EQ(smallest.size(), 2U) << outcome.out;
  EXPECT_LE(smallest[0], smallest[1]);
  EXPECT_NEAR(smallest[0], 2.0, 1e-5);
  EXPECT_NEAR(smallest[1], 2.0, 1e-5);
  EXPECT_THAT(outcome.out, HasSubstr("kept, proven of the whole surface"));
}

TEST_F(ShownCommands, FitBeginsElsewhere) {
  static const std::regex start(R"(--pose-start ([-0-9.]+),)");
  std::smatch match;
  const std::string command = command_with(" fit ");
  ASSERT_TRUE(std::regex_search(command, match, start)) << command;
  EXPECT_GT(std::abs(std::stod(match[1])), 1.0);
}

TEST_F(ShownCommands, SurfaceIsClosed) {
  if (!VERISQ_HAS_SURFACE) GTEST_SKIP() << "built without CGAL";
  const Outcome outcome = as_printed(command_with(" surface "));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("closed             yes\n"));
  EXPECT_THAT(outcome.out, HasSubstr("components         1\n"));
  EXPECT_THAT(outcome.out, HasSubstr("genus 0\n"));
}

TEST_F(ShownCommands, ShowsModelsThatAreRead) {
  const std::vector<std::string> models = fenced_blocks(commands_document(), "json");
  ASSERT_FALSE(models.empty());
  for (const std::string& model : models) EXPECT_FALSE(read_model(write("shown.json", model)).primitives.empty());
}

// Each block of commands is followed by lines of what they print, or by the beginnings of such lines.
TEST_F(ShownCommands, PrintWhatTheTutorialSays) {
  const std::string tutorial = contents(root / "docs" / "tutorial.md");
  static const std::regex shown(R"(```sh\n([^`]*)```\n\n```text\n([^`]*)```\n)");
  std::size_t lines = 0;
  for (std::sregex_iterator match(tutorial.begin(), tutorial.end(), shown); match != std::sregex_iterator(); ++match) {
    std::string printed = "\n";
    for (const std::string& command : commands_in("```sh\n" + (*match)[1].str() + "```\n")) {
      const Outcome outcome = as_printed(command);
      EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.err;
      printed += outcome.out;
    }
    std::istringstream said((*match)[2]);
    for (std::string line; std::getline(said, line); ++lines) EXPECT_THAT(printed, HasSubstr("\n" + line));
  }
  EXPECT_GE(lines, 10U);
}

/// Whether each block of `language` is the text of one of these files, or a part of it.
void expect_contained(const std::string& language, const std::vector<std::filesystem::path>& files) {
  const std::vector<std::string> blocks = fenced_blocks(contents(root / "docs" / "library.md"), language);
  EXPECT_FALSE(blocks.empty()) << language;
  for (const std::string& block : blocks) {
    const bool contained = std::ranges::any_of(
        files, [&](const std::filesystem::path& file) { return contents(file).find(block) != std::string::npos; });
    EXPECT_TRUE(contained) << "no example holds\n" << block;
  }
}

// The examples themselves are built and run against the installed package: tests/consumer.
TEST_F(ShownCommands, ShowsCodeOfTheExamples) {
  std::vector<std::filesystem::path> sources;
  for (const auto& entry : std::filesystem::directory_iterator(root / "examples" / "cpp")) {
    if (entry.path().extension() == ".cpp") sources.push_back(entry.path());
  }
  expect_contained("cpp", sources);
  expect_contained("cmake", {root / "examples" / "cpp" / "CMakeLists.txt"});
}

}  // namespace
}  // namespace verisq::testing
