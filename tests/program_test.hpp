/// What the tests of every command have in common: a folder for its files, the started program, the maps it leaves.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>
#include <verisq/enclosure.hpp>

#include "tests/process.hpp"
#include "tests/temporary_folder.hpp"

namespace verisq::testing {

using Arguments = std::vector<std::string>;

class ProgramTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    return folder_.file(name, text).string();
  }

  [[nodiscard]] Process start(Arguments arguments) const {
    arguments.insert(arguments.begin(), VERISQ_PROGRAM);
    return {arguments, folder_.path()};
  }
  [[nodiscard]] Outcome run(const Arguments& arguments) const { return start(arguments).wait(); }

  /// Ctrl-C, or what else asks a program to end, shortly after it is ready for that.
  [[nodiscard]] Outcome run_interrupted(const Arguments& arguments, int signal = SIGINT) const {
    const Process process = start(arguments);
    process.wait_until_interruptible();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // to have some results; the tests do without
    process.send(signal);
    return process.wait();
  }

  TemporaryFolder folder_;
};

/// One line on the standard error that has all `words`, nothing on the standard output, exit status 2.
inline void expect_refused(const Outcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ::testing::StartsWith("verisq: "));
  EXPECT_THAT(outcome.err, ::testing::EndsWith("\n"));
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  for (const std::string& word : words) EXPECT_THAT(outcome.err, ::testing::HasSubstr(word));
}

struct Row {
  std::size_t index;
  Enclosure distance;
  std::string status;
};

/// Of a .csv map without certificates.
inline std::vector<Row> rows_of(const std::filesystem::path& csv) {
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "index,lo,hi,status");
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string index;
    std::string lo;
    std::string hi;
    std::string status;
    std::getline(std::getline(std::getline(fields, index, ','), lo, ','), hi, ',') >> status;
    rows.push_back({std::stoul(index), {std::stod(lo), std::stod(hi)}, status});
  }
  return rows;
}

}  // namespace verisq::testing
