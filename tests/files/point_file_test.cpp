/// Streaming of points from text: forms of lines, chunks, blocks, and the message for everything refused. Those of
/// arrays stand in npy_points_test.cpp.
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/read_all.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using testing::TemporaryFolder;

/// All points of the file, read `chunk` at a time.
std::vector<Point> read_all(const std::filesystem::path& path, std::size_t chunk) {
  return testing::read_all<Point>(PointFile(path), chunk);
}

std::vector<Point> read_text(std::string_view text) {
  const TemporaryFolder folder;
  return read_all(folder.file("p.csv", text), 2);
}

void expect_refusal(std::string_view text, const std::string& rest) {
  const TemporaryFolder folder;
  const auto path = folder.file("p.csv", text);
  expect_input_error([&] { (void)read_all(path, 2); }, path, rest);
}

TEST(PointFile, FormsOfLines) {
  const auto expected = ElementsAre(Point{1, -2.5, 3e2}, Point{0.1, 0, -0.0}, Point{7, 8, 9});
  EXPECT_THAT(read_text("x,y,z\n1,-2.5,3e2\n0.1,0,-0\n7,8,9\n"), expected);
  EXPECT_THAT(read_text("1,-2.5,3e2\n0.1,0,-0\n7,8,9"), expected);
  EXPECT_THAT(read_text("X, Y, Z\r\n 1 ,\t-2.5, +3e2 \r\n.1,0.,-0\r\n7,8,9\r\n\r\n  \n\n"), expected);
  EXPECT_THAT(read_text("\xEF\xBB\xBF\"x\",\"y\",\"z\"\n1,-2.5,3e2\n0.1,1e-400,-0\n7,8,9\n"), expected);
  EXPECT_THAT(read_text("\xEF\xBB\xBF"
                        "1,-2.5,3e2\n0.1,0,-0\n7,8,9\n"),
              expected);
}

TEST(PointFile, SeparatorsAreThoseOfTheFirstLine) {
  const auto expected = ElementsAre(Point{1, -2.5, 3e2}, Point{0.1, 0, -0.0}, Point{7, 8, 9});
  EXPECT_THAT(read_text("1 -2.5 3e2\n0.1 0 -0\n7 8 9\n"), expected);
  EXPECT_THAT(read_text("X\tY\tZ\r\n  1\t -2.5 +3e2 \r\n.1 0. -0\r\n7  8  9\r\n \r\n"), expected);
  EXPECT_THAT(read_text("\xEF\xBB\xBFx y z\n1 -2.5 3e2\n0.1 1e-400 -0\n7 8 9"), expected);
}

TEST(PointFile, PassesOverOtherColumns) {
  const auto expected = ElementsAre(Point{1, 2, 3}, Point{4, 5, 6});
  EXPECT_THAT(read_text("1,2,3,red\n4,5,6,nan\n"), expected);
  EXPECT_THAT(read_text("1,2,3,,\n4,5,6,7,\n"), expected);
  EXPECT_THAT(read_text("1 2 3 0.5 0.25\n4 5 6 x y\n"), expected);
  EXPECT_THAT(read_text("id,\"Z\",name, x ,y\nfirst,3,,1,2\n,6,a b,4,5\n"), expected);
  EXPECT_THAT(read_text("normal z y x\n0 3 2 1\r\n0 6 5 4\r\n"), expected);
  EXPECT_THAT(read_text("//X Y Z\n1 2 3\n4 5 6\n"), expected);
  EXPECT_THAT(read_text("# z, y, x\n3,2,1\n6,5,4\n"), expected);
}

TEST(PointFile, RefusesOtherColumnsThatComeAndGo) {
  expect_refusal("1,2,3,4\n1,2,3\n", ": line 2: '1,2,3': expected 4 fields as in the first line, found 3");
  expect_refusal("x y z w\n1 2 3 4 5\n", ": line 2: '1 2 3 4 5': expected 4 fields as in the first line, found 5");
  expect_refusal("x,y,z,w\n1 2 3 4\n", ": line 2: '1 2 3 4': expected 4 fields as in the first line, found 1");
  expect_refusal("w,x,y,z,x\n1,2,3,4,5\n", ": line 1: column x is there 2 times");
  expect_refusal("w,x,y,z\n1,2,3,\n", ": line 2: z is missing");
  expect_refusal("w,y,z,x\n1,2,3,4\n1,2,inf,4\n", ": line 3: z = 'inf': not a finite number");
  expect_refusal("w,y,z\n1,2,3\n", ": line 1: x = 'w': not a number");
}

TEST(PointFile, ReadsToTheNearestBinary64) {
  EXPECT_THAT(
      read_text("1.00000000000000011102230246251565404,1.00000000000000011102230246251565405,4e-324\n"),
      ElementsAre(Point{1.0, 1.0 + std::numeric_limits<double>::epsilon(), std::numeric_limits<double>::denorm_min()}));
}

TEST(PointFile, StreamsAcrossChunksAndBlocks) {
  constexpr std::size_t count = 150000;
  std::string text = "x,y,z\n";
  for (std::size_t k = 0; k < count; ++k) text += std::to_string(k) + ".25,-" + std::to_string(k) + ",1e-3\n";
  ASSERT_GT(text.size(), std::size_t{1} << 21);
  const TemporaryFolder folder;
  const auto path = folder.file("p.csv", text);
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{7}, std::size_t{4096}, count, count + 1}) {
    const std::vector<Point> points = read_all(path, chunk);
    ASSERT_EQ(points.size(), count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto value = static_cast<double>(k);
      ASSERT_EQ(points[k], (Point{value + 0.25, -value, 1e-3}));
    }
  }
}

/// The rows before the one that is refused arrive, and its number counts all lines.
TEST(PointFile, RefusesFarIntoAFile) {
  constexpr std::size_t good = 120000;
  std::string text = "x,y,z\n";
  for (std::size_t k = 0; k < good; ++k) text += k % 1000 == 0 ? "+0.125,1e-400,-3\n" : "0.125,0,-3\n";
  const TemporaryFolder folder;
  const auto path = folder.file("p.csv", text + "1,2,three\n" + text);
  PointFile file(path);
  std::vector<Point> points(good);
  EXPECT_EQ(file.read(points), good);
  EXPECT_THAT(points, ::testing::Each(Point{0.125, 0.0, -3.0}));
  expect_input_error([&] { file.read(points); }, path, ": line 120002: z = 'three': not a number");
  const auto blank = folder.file("blank.csv", text + "\n \n" + text);
  expect_input_error([&] { (void)read_all(blank, 1000); }, blank,
                     ": line 120004: a point after a blank line: blank lines are fine at the end only");
}

TEST(PointFile, EndsWithoutPointsAgainAndAgain) {
  const TemporaryFolder folder;
  PointFile file(folder.file("p.csv", "1,2,3\n\n"));
  std::vector<Point> points(5);
  EXPECT_EQ(file.read(points), 1U);
  EXPECT_EQ(file.read(points), 0U);
  EXPECT_EQ(file.read(points), 0U);
}

TEST(PointFile, CountsBytesForProgress) {
  const TemporaryFolder folder;
  PointFile file(folder.file("p.csv", "1,2,3\n4,5,6\n"));
  EXPECT_EQ(file.bytes_total(), 12U);
  EXPECT_EQ(file.bytes_read(), 0U);
  std::vector<Point> one(1);
  EXPECT_EQ(file.read(one), 1U);
  EXPECT_EQ(file.bytes_read(), 6U);
  EXPECT_EQ(file.read(one), 1U);
  EXPECT_EQ(file.bytes_read(), 12U);
}

TEST(PointFile, RefusesValues) {
  expect_refusal("1,2,3\n4,nan,6\n", ": line 2: y = 'nan': not a finite number");
  expect_refusal("nan,nan,nan\n", ": line 1: x = 'nan': not a finite number");
  expect_refusal("x,y,z\n1,2,-Infinity\n", ": line 2: z = '-Infinity': not a finite number");
  expect_refusal("1e999,2,3\n", ": line 1: x = '1e999': beyond the range of binary64");
  expect_refusal("1,2,3\n1,2,3\n1,two,3\n", ": line 3: y = 'two': not a number");
  expect_refusal("1,2,3mm\n", ": line 1: z = '3mm': not a number");
  expect_refusal("1,0x2,3\n", ": line 1: y = '0x2': not a number");
  expect_refusal("1,--2,3\n", ": line 1: y = '--2': not a number");
  expect_refusal("1,+-2,3\n", ": line 1: y = '+-2': not a number");
  expect_refusal("1,2 2,3\n", ": line 1: y = '2 2': not a number");
  expect_refusal("1,,3\n", ": line 1: y is missing");
  expect_refusal(std::string("1,2\0,3\n", 7), ": line 1: y = '2\\x00': not a number");
}

TEST(PointFile, RefusesLines) {
  expect_refusal("1,2\n", ": line 1: '1,2': expected three numbers x,y,z");
  expect_refusal("1,2,3\n1,2,3,4\n", ": line 2: '1,2,3,4': expected three numbers x,y,z");
  expect_refusal("1 2\n", ": line 1: '1 2': expected three numbers x,y,z");
  expect_refusal("1,2,3\n1 2 3\n", ": line 2: '1 2 3': expected three numbers x,y,z");
  expect_refusal("1;2;3\n", ": line 1: '1;2;3': expected three numbers x,y,z");
  expect_refusal("x,y,z\n# comment\n", ": line 2: '# comment': expected three numbers x,y,z");
  expect_refusal("a,b,c\n1,2,3\n", ": line 1: x = 'a': not a number");
  expect_refusal("1,2,3\nx,y,z\n", ": line 2: x = 'x': not a number");
  expect_refusal("1,2,3\n\n \n4,5,6\n", ": line 4: a point after a blank line: blank lines are fine at the end only");
  expect_refusal("1,2,3\rx\n", ": line 1: z = '3\\x0dx': not a number");
  expect_refusal(std::string(100, 'a') + "\n",
                 ": line 1: '" + std::string(60, 'a') + "...': expected three numbers x,y,z");
}

TEST(PointFile, RefusesFiles) {
  expect_refusal("", ": the file is empty");
  expect_refusal("x,y,z\n", ": no points");
  expect_refusal("\n\n", ": no points");
  const TemporaryFolder folder;
  expect_input_error([&] { PointFile file(folder / "none.csv"); }, folder / "none.csv", ": no such file");
  expect_input_error([&] { PointFile file(folder.path()); }, folder.path(), ": is a directory, not a file");
}

}  // namespace
}  // namespace verisq
