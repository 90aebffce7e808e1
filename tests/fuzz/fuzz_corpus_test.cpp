/// Replays the seeds of the fuzz targets, every input among them that once broke a reader, without a fuzzer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {
namespace {

std::vector<std::filesystem::path> seeds(const Target& target) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(VERISQ_CORPUS) / target.name)) {
    paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

std::vector<std::uint8_t> contents(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class FuzzCorpus : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, KeepsEveryPromise) {
  const std::vector<std::filesystem::path> paths = seeds(GetParam());
  EXPECT_FALSE(paths.empty());
  for (const std::filesystem::path& path : paths) {
    EXPECT_NO_THROW(GetParam().run(contents(path))) << path;
  }
}

/// A valid prefix reaches deeper than random bytes do: cheap, and without a fuzzer.
TEST_P(FuzzCorpus, KeepsEveryPromiseWhenTruncated) {
  for (const std::filesystem::path& path : seeds(GetParam())) {
    const std::vector<std::uint8_t> whole = contents(path);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_NO_THROW(GetParam().run(Bytes(whole).first(size))) << path << ", first " << size << " bytes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Target, FuzzCorpus, ::testing::ValuesIn(targets),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace verisq::fuzz
