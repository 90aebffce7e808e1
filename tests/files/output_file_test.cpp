/// Files that appear when they are complete: where symbolic links lead to, with the permissions of what they replace,
/// and never in place of a device or a pipe.
#include "host/files/output_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_error;
using testing::TemporaryFolder;
using ::testing::UnorderedElementsAre;

void write(const std::filesystem::path& name, std::string_view text) {
  OutputFile file(name);
  file.write(text);
  file.finish();
}

struct stat status_of(const std::filesystem::path& path) {
  struct stat status = {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status;
}

unsigned permissions_of(const std::filesystem::path& path) {
  return status_of(path).st_mode & 07777U;
}

TEST(OutputFile, FollowsLinksToTheirTarget) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "far");
  (void)folder.file("far/old.txt", "old");
  std::filesystem::create_symlink("far/old.txt", folder / "relative");
  std::filesystem::create_symlink(folder / "relative", folder / "absolute");
  std::filesystem::create_symlink("far/new.txt", folder / "dangling");
  write(folder / "absolute", "new");
  write(folder / "dangling", "fresh");
  EXPECT_EQ(folder.contents("far/old.txt"), "new");
  EXPECT_EQ(folder.contents("far/new.txt"), "fresh");
  for (const char* link : {"relative", "absolute", "dangling"}) {
    EXPECT_TRUE(std::filesystem::is_symlink(folder / link)) << link;
  }
  EXPECT_THAT(folder.names(), UnorderedElementsAre("far", "relative", "absolute", "dangling"));
}

TEST(OutputFile, KeepsThePartBesideTheTargetOfALink) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "far");
  std::filesystem::create_symlink("far/map.csv", folder / "link.csv");
  OutputFile file(folder / "link.csv");
  file.write("part");
  EXPECT_EQ(file.finish_as_partial(), folder / "far/map.csv.partial");
  EXPECT_EQ(folder.contents("far/map.csv.partial"), "part");
}

TEST(OutputFile, RefusesLinksInCirclesAndIntoNowhere) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  std::filesystem::create_symlink("none/file", folder / "nowhere");
  expect_error([&] { OutputFile file(folder / "a"); }, ErrorKind::failure, (folder / "a").string(),
               ": cannot be written: Too many levels of symbolic links");
  expect_error([&] { OutputFile file(folder / "nowhere"); }, ErrorKind::failure, (folder / "nowhere").string(),
               ": cannot be written: No such file or directory");
}

TEST(OutputFile, TakesOverThePermissionsOfWhatItReplaces) {
  const TemporaryFolder folder;
  for (const unsigned mode : {0600U, 0640U, 0755U, 0666U}) {
    const auto path = folder.file("file", "old");
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    write(path, "new");
    EXPECT_EQ(permissions_of(path), mode);
    EXPECT_EQ(folder.contents("file"), "new");
  }
}

TEST(OutputFile, HasUsualPermissionsWhereItReplacesNothing) {
  const TemporaryFolder folder;
  write(folder / "new", "text");
  EXPECT_EQ(permissions_of(folder / "new"), permissions_of(folder.file("usual", "text")));
}

TEST(OutputFile, LeavesAFileToItsOwner) {
  if (geteuid() != 0) GTEST_SKIP() << "only the superuser gives files away";
  const TemporaryFolder folder;
  const auto path = folder.file("file", "old");
  ASSERT_EQ(chown(path.c_str(), 1234, 5678), 0);
  write(path, "new");
  EXPECT_EQ(status_of(path).st_uid, 1234U);
  EXPECT_EQ(status_of(path).st_gid, 5678U);
}

/// A device like /dev/null, without a risk to that.
TEST(OutputFile, DoesNotReplaceADevice) {
  const TemporaryFolder folder;
  const auto null = folder / "null";
  if (mknod(null.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0) GTEST_SKIP() << "no right to make devices";
  std::filesystem::create_symlink(null, folder / "link");
  for (const char* name : {"null", "link"}) {
    try {
      write(folder / name, "text");
    } catch (const Error& error) {  // where the folder's file system allows no devices
      EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr("Permission denied"));
    }
    EXPECT_TRUE(std::filesystem::is_character_file(null));
  }
  EXPECT_THAT(folder.names(), UnorderedElementsAre("null", "link"));
}

TEST(OutputFile, WritesToNullItself) {
  OutputFile file("/dev/null");
  file.write("text");
  file.finish();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFile, WritesIntoAPipe) {
  const TemporaryFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  { const OutputFile trial(pipe); }  // neither waits for a reader nor ends one's input
  auto reader = std::async(std::launch::async, [&] { return folder.contents("pipe"); });
  write(pipe, "text");
  EXPECT_EQ(reader.get(), "text");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_THAT(folder.names(), ElementsAre("pipe"));
}

TEST(OutputFile, HandsOnWhatIsFlushed) {
  const TemporaryFolder folder;
  std::optional<OutputFile> file(folder / "map.csv");
  file->write("whole\n");
  file->flush();
  file->write("half");
  const auto names = folder.names();
  ASSERT_EQ(names.size(), 1U);
  EXPECT_THAT(names[0], ::testing::MatchesRegex("map\\.csv\\.[0-9a-f]{8}\\.partial"));
  EXPECT_EQ(folder.contents(names[0]), "whole\n");
  file.reset();
  EXPECT_THAT(folder.names(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace verisq
