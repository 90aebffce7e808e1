/// The cache gives back what was stored or nothing, whatever happens to its files: full disks, damage, other processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq::device {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::string_view key = "program\nsome device\n-DOPTION\nkernel void nothing() {}";
const std::string content("\0binary\n\r\xff and more", 17);

class CacheTest : public ::testing::Test {
 protected:
  void SetUp() override { use(folder_.path()); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  static void use(const std::filesystem::path& home) { setenv("XDG_CACHE_HOME", home.c_str(), 1); }

  [[nodiscard]] std::filesystem::path directory() const { return folder_ / "verisq"; }

  [[nodiscard]] std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> all;
    for (const auto& entry : std::filesystem::directory_iterator(directory())) all.push_back(entry.path());
    return all;
  }

  /// The file of the one key that is stored.
  [[nodiscard]] std::filesystem::path file() const {
    EXPECT_THAT(files(), SizeIs(1));
    return files().at(0);
  }

  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  static void write(const std::filesystem::path& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  const testing::TemporaryFolder folder_;
};

TEST_F(CacheTest, GivesBackWhatWasStored) {
  EXPECT_EQ(cached(key), std::nullopt);
  store_in_cache(key, content);
  EXPECT_EQ(cached(key), content);
  EXPECT_EQ(cached("another key"), std::nullopt);
  store_in_cache(key, "");
  EXPECT_EQ(cached(key), "");
}

TEST(ChecksumTest, IsTheStandardOne) {
  EXPECT_EQ(checksum("123456789"), 0x995dc9bbdf1939faU);  // the check value of CRC-64/XZ
}

/// Restores the limit and the signal, which a file beyond the limit raises.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : earlier_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &earlier_);
    const rlimit limit{bytes, earlier_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &earlier_);
    std::signal(SIGXFSZ, earlier_signal_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit earlier_{};
  void (*earlier_signal_)(int);
};

TEST_F(CacheTest, KeepsNothingThatDoesNotFit) {
  store_in_cache(key, content);
  const auto whole = static_cast<rlim_t>(std::filesystem::file_size(file()));
  for (rlim_t size = 0; size < whole; ++size) {
    std::filesystem::remove_all(directory());
    {
      const FileSizeLimit limit(size);
      store_in_cache(key, content);
    }
    EXPECT_EQ(cached(key), std::nullopt) << size << " bytes of " << whole;
    EXPECT_THAT(files(), IsEmpty()) << size << " bytes of " << whole;
  }
  {
    const FileSizeLimit limit(whole);
    store_in_cache(key, content);
  }
  EXPECT_EQ(cached(key), content);
}

TEST_F(CacheTest, RemovesTruncatedFiles) {
  store_in_cache(key, content);
  const std::string whole = bytes_of(file());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    store_in_cache(key, content);
    write(file(), whole.substr(0, length));
    EXPECT_EQ(cached(key), std::nullopt) << length << " bytes of " << whole.size();
    EXPECT_THAT(files(), IsEmpty()) << length << " bytes of " << whole.size();
  }
}

TEST_F(CacheTest, RemovesFilesWithAnyBitFlipped) {
  store_in_cache(key, content);
  const std::string whole = bytes_of(file());
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    store_in_cache(key, content);
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    write(file(), damaged);
    EXPECT_EQ(cached(key), std::nullopt) << "bit " << bit;
    EXPECT_THAT(files(), IsEmpty()) << "bit " << bit;
  }
}

TEST_F(CacheTest, RemovesFilesThatGoOnAfterTheirEnd) {
  store_in_cache(key, content);
  write(file(), bytes_of(file()) + "x");
  EXPECT_EQ(cached(key), std::nullopt);
  EXPECT_THAT(files(), IsEmpty());
}

// As when two keys get the same name: both are served in turn, neither is taken for the other.
TEST_F(CacheTest, TellsKeysApartWhateverTheirFilesAreCalled) {
  store_in_cache(key, content);
  const std::filesystem::path own = file();
  store_in_cache("another key", "another content");
  for (const auto& path : files())
    if (path != own) std::filesystem::rename(path, own);
  EXPECT_EQ(cached(key), std::nullopt);
  EXPECT_THAT(files(), ElementsAre(own)) << "intact, if not ours";
  store_in_cache(key, content);
  EXPECT_EQ(cached(key), content);
}

TEST_F(CacheTest, LivesWithWhatIsNoFile) {
  store_in_cache(key, content);
  const std::filesystem::path path = file();
  const auto expect_no_cache = [&] {
    EXPECT_EQ(cached(key), std::nullopt);
    store_in_cache(key, content);
  };
  std::filesystem::remove(path);
  std::filesystem::create_directories(path / "with something in it");
  expect_no_cache();
  EXPECT_EQ(cached(key), std::nullopt);
  EXPECT_THAT(files(), ElementsAre(path)) << "no temporary file is left";
  std::filesystem::remove_all(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  expect_no_cache();  // without waiting for someone to write
  EXPECT_EQ(cached(key), content);
}

TEST_F(CacheTest, DoesWithoutADirectory) {
  const auto expect_nothing = [] {
    store_in_cache(key, content);
    EXPECT_EQ(cached(key), std::nullopt);
  };
  use(folder_.file("a file", "") / "below");
  expect_nothing();
  use("/dev/null");
  expect_nothing();
  use("/proc");  // where even root creates nothing
  expect_nothing();
}

TEST_F(CacheTest, ServesSeveralProcessesAtOnce) {
  constexpr int processes = 8;
  constexpr int rounds = 200;
  const auto content_of = [](int process) { return std::string(10'000 + process, static_cast<char>('a' + process)); };
  std::vector<pid_t> children;
  for (int process = 0; process < processes; ++process) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      bool sound = true;
      for (int round = 0; round < rounds; ++round) {
        store_in_cache(key, content_of(process));
        const auto found = cached(key);
        sound = sound && found && *found == content_of(found->at(0) - 'a');
      }
      _exit(sound ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_THAT(files(), SizeIs(1));
}

TEST_F(CacheTest, RemovesWhatKilledProcessesLeft) {
  store_in_cache(key, content);
  const std::filesystem::path stored = file();
  const auto left = [&](std::string_view name, std::chrono::hours age) {
    const std::filesystem::path path = directory() / name;
    write(path, "half a fi");
    std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - age);
    return path;
  };
  left("0123456789abcdef.0123abcd.partial", std::chrono::hours(2));
  left("0123456789abcdef.4711", std::chrono::hours(2));  // as earlier versions called them
  const auto being_written = left("0123456789abcdef.fedcba98.partial", std::chrono::hours(0));
  std::filesystem::last_write_time(stored, std::filesystem::file_time_type::clock::now() - std::chrono::hours(9999));
  store_in_cache("another key", content);
  EXPECT_THAT(files(), SizeIs(3));
  EXPECT_TRUE(std::filesystem::exists(being_written));
  EXPECT_EQ(cached(key), content);
  EXPECT_EQ(cached("another key"), content);
}

}  // namespace
}  // namespace verisq::device
