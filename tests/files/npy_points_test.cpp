/// Points from NumPy arrays: types, orders, streaming, and the message for every header that is refused.
#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/read_all.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using testing::TemporaryFolder;

const std::vector<Point> some_points{{1, -2.5, 0x1p-1074}, {0.1F, -0.0, 3e38F}, {7, 8, 9}};

/// A file as numpy.save writes it, version 1.0.
std::string array(const std::string& literal, const std::string& numbers, std::string version = {'\1', '\0'}) {
  std::string length{static_cast<char>(literal.size() % 256), static_cast<char>(literal.size() / 256)};
  if (version[0] != '\1') length += std::string(2, '\0');
  return "\x93NUMPY" + version + length + literal + numbers;
}

std::string literal(const std::string& descr, bool fortran_order, const std::string& shape) {
  return "{'descr': '" + descr + "', 'fortran_order': " + (fortran_order ? "True" : "False") + ", 'shape': " + shape +
         ", }          \n";
}

template <class Number>
std::string bytes_of(double value, std::endian order) {
  auto number = static_cast<Number>(value);
  if (order != std::endian::native) number = reversed_bytes(number);
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

template <class Number>
std::string numbers(const std::vector<Point>& points, std::endian order, bool fortran_order) {
  std::string bytes;
  if (fortran_order) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const Point& point : points) bytes += bytes_of<Number>(point[axis], order);
    }
  } else {
    for (const Point& point : points) {
      for (const double coordinate : point) bytes += bytes_of<Number>(coordinate, order);
    }
  }
  return bytes;
}

std::string doubles(const std::vector<Point>& points) {
  return numbers<double>(points, std::endian::little, false);
}

std::vector<Point> read_all(const std::filesystem::path& path, std::size_t chunk) {
  return testing::read_all<Point>(PointFile(path), chunk);
}

void expect_refusal(const std::string& contents, const std::string& rest) {
  const TemporaryFolder folder;
  const auto path = folder.file("p.npy", contents);
  expect_input_error([&] { (void)read_all(path, 2); }, path, rest);
}

TEST(NpyPoints, TypesAndOrders) {
  const TemporaryFolder folder;
  for (const bool fortran_order : {false, true}) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const std::string sign = order == std::endian::little ? "<" : ">";
      const auto f8 = folder.file("f8.npy", array(literal(sign + "f8", fortran_order, "(3, 3)"),
                                                  numbers<double>(some_points, order, fortran_order)));
      EXPECT_EQ(read_all(f8, 2), some_points);
      const auto f4 = folder.file("f4.npy", array(literal(sign + "f4", fortran_order, "(3, 3)"),
                                                  numbers<float>(some_points, order, fortran_order)));
      const std::vector<Point> single{{1, -2.5, 0}, {0.1F, -0.0, 3e38F}, {7, 8, 9}};
      EXPECT_EQ(read_all(f4, 2), single);
    }
  }
}

TEST(NpyPoints, Headers) {
  const TemporaryFolder folder;
  const std::string plain = literal("<f8", false, "(3, 3)");
  for (const std::string& contents :
       {array(plain, doubles(some_points)), array(plain, doubles(some_points), {'\2', '\0'}),
        array(plain, doubles(some_points), {'\3', '\0'}),
        array("{\"shape\":(3,3,),\"fortran_order\":False,\"descr\":\"<f8\"}", doubles(some_points))}) {
    EXPECT_EQ(read_all(folder.file("p.npy", contents), 2), some_points);
    EXPECT_EQ(read_all(folder.file("named_otherwise.csv", contents), 5), some_points);
  }
}

TEST(NpyPoints, StreamsAcrossChunksAndBlocks) {
  constexpr std::size_t count = 100000;
  std::vector<Point> expected(count);
  for (std::size_t k = 0; k < count; ++k)
    expected[k] = {static_cast<double>(k), -0.5, 1.0 / static_cast<double>(k + 1)};
  const TemporaryFolder folder;
  for (const bool fortran_order : {false, true}) {
    const auto path = folder.file("p.npy", array(literal("<f8", fortran_order, "(100000, 3)"),
                                                 numbers<double>(expected, std::endian::little, fortran_order)));
    for (const std::size_t chunk : {std::size_t{7}, std::size_t{4096}, count, count + 1}) {
      EXPECT_EQ(read_all(path, chunk), expected);
    }
  }
}

TEST(NpyPoints, KnowsHowMany) {
  const TemporaryFolder folder;
  const auto path = folder.file("p.npy", array(literal("<f8", false, "(3, 3)"), doubles(some_points)));
  PointFile file(path);
  EXPECT_EQ(file.count(), 3U);
  EXPECT_EQ(file.bytes_total(), std::filesystem::file_size(path));
  EXPECT_EQ(file.bytes_read(), 0U);
  std::vector<Point> points(3);
  EXPECT_EQ(file.read(points), 3U);
  EXPECT_EQ(file.bytes_read(), file.bytes_total());
  EXPECT_EQ(file.read(points), 0U);
  EXPECT_EQ(PointFile(folder.file("p.csv", "1,2,3\n")).count(), std::nullopt);
}

TEST(NpyPoints, RefusesNumbersThatAreNotFinite) {
  auto points = some_points;
  points[1][2] = std::numeric_limits<double>::quiet_NaN();
  const std::string c_order = literal("<f8", false, "(3, 3)");
  const std::string fortran_order = literal("<f8", true, "(3, 3)");
  constexpr std::size_t preamble = 10;  // magic, version and the literal's length
  const auto byte = [](const std::string& header, std::size_t number, std::size_t size) {
    return ": byte " + std::to_string(preamble + header.size() + number * size);
  };
  expect_refusal(array(c_order, doubles(points)),
                 byte(c_order, 5, sizeof(double)) + ": z of point 1 = nan: not a finite number");
  expect_refusal(array(fortran_order, numbers<double>(points, std::endian::little, true)),
                 byte(fortran_order, 7, sizeof(double)) + ": z of point 1 = nan: not a finite number");
  points[1][2] = -std::numeric_limits<double>::infinity();
  const std::string single = literal(">f4", false, "(3, 3)");
  expect_refusal(array(single, numbers<float>(points, std::endian::big, false)),
                 byte(single, 5, sizeof(float)) + ": z of point 1 = -inf: not a finite number");
}

TEST(NpyPoints, RefusesOtherArrays) {
  const std::string data = doubles(some_points);
  const std::string known = ": expected float64 or float32: '<f8', '>f8', '<f4', '>f4'";
  expect_refusal(array(literal("<i8", false, "(3, 3)"), data), ": byte 10: descr = '<i8'" + known);
  expect_refusal(array(literal("|O", false, "(3, 3)"), data), ": byte 10: descr = '|O'" + known);
  expect_refusal(array(literal("<f8", false, "(9,)"), data), ": byte 10: shape = (9): expected (N, 3)");
  expect_refusal(array(literal("<f8", false, "()"), data), ": byte 10: shape = (): expected (N, 3)");
  expect_refusal(array(literal("<f8", false, "(3, 3, 1)"), data), ": byte 10: shape = (3, 3, 1): expected (N, 3)");
  expect_refusal(array(literal("<f8", false, "(4, 2)"), data), ": byte 10: shape = (4, 2): expected (N, 3)");
  expect_refusal(array(literal("<f8", false, "(0, 3)"), ""), ": no points");
  expect_refusal(array(literal("<f8", false, "(18446744073709551615, 3)"), data),
                 ": byte 10: shape = (18446744073709551615, 3): more than a file can hold");
  expect_refusal(array("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (3,)}", data),
                 ": byte 10: header of the array: descr = '[('x', '<f8')], 'fortran_order': False, 'shape': (3,)}': "
                 "elements with fields, expected plain numbers");
}

TEST(NpyPoints, RefusesOtherLengths) {
  const std::string header = literal("<f8", false, "(3, 3)");
  const std::string data = doubles(some_points);
  expect_refusal(array(header, data.substr(1)), ": truncated: 3 points are 72 bytes, and 71 follow the header");
  expect_refusal(array(header, data + "more"),
                 ": byte " + std::to_string(10 + header.size() + 72) + ": 4 bytes after the last point");
  expect_refusal(array(literal("<f8", false, "(384307168202282324, 3)"), data),
                 ": truncated: 384307168202282324 points are 9223372036854775776 bytes, and 72 follow the header");
}

TEST(NpyPoints, RefusesHostileHeaders) {
  const auto expect_refused = [](const std::string& text, const std::string& message) {
    expect_refusal(array(text, ""), ": byte 10: header of the array: " + message);
  };
  expect_refused("[1, 2]", "'[1, 2]': expected '{'");
  expect_refused("{'descr': '<f8'", "the end: expected '}'");
  expect_refused("{'descr': '<f8', }", "no key 'fortran_order'");
  expect_refused("{'descr': '<f8', 'descr': '<f8'}", "key 'descr' twice");
  expect_refused("{'descr': '<f8', 'fortran_order': 1}", "fortran_order = '1}': expected True or False");
  expect_refused("{'shape': (-3, 3)}", "shape: '-3, 3)}': not a size");
  expect_refused("{'shape': (99999999999999999999, 3)}", "shape: '99999999999999999999, 3)}': not a size");
  expect_refused("{'shape': [3, 3]}", "'[3, 3]}': expected '('");
  expect_refused("{'descr': __import__('os')}", "'__import__('os')}': expected descr");
  expect_refused("{'evil': 1}", "unknown key 'evil'");
  expect_refused("{'descr", "''descr': expected a key");
  expect_refused("{} {}", "unexpected '{}' after it");
  expect_refused("", "the end: expected '{'");
}

TEST(NpyPoints, RefusesOtherFiles) {
  expect_refusal("1,2,3\n", ": not a NumPy array: begins with '1,2,3\\x0a', expected '\\x93NUMPY'");
  expect_refusal("\x93NUM", ": not a NumPy array: begins with '\\x93NUM', expected '\\x93NUMPY'");
  expect_refusal("\x93NUMPY", ": byte 6: truncated: the file ends after 6 bytes, inside the version of the array");
  expect_refusal(std::string("\x93NUMPY\4\0xx", 10), ": byte 6: version 4.0 of .npy: known are 1.0, 2.0, 3.0");
  expect_refusal(std::string("\x93NUMPY\2\0\xff\xff\xff\xff", 12),
                 ": byte 8: header of 4294967295 bytes: longer than 10000");
  expect_refusal(std::string("\x93NUMPY\1\0\5\0{}", 12),
                 ": byte 10: truncated: the file ends after 12 bytes, inside the header of the array");
  expect_refusal("", ": the file is empty");
}

}  // namespace
}  // namespace verisq
