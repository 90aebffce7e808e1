/// Meshes of VTK: every encoding of `.vtp` and `.vtk` gives the same mesh, and the message for everything refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using ::testing::HasSubstr;
using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t npos = std::string::npos;

// --- one mesh, as numbers ----------------------------------------------------------------------------------------

const std::vector<double> coordinates{0, 0, 0, 1, 0, 0, 1, 1, 0,   0, 1, 0,    0.5, 0.25, 1,
                                      3, 0, 0, 3, 1, 0, 4, 0, 0.5, 4, 1, 0.25, 5,   0.5,  0};
const std::vector<std::int64_t> polygons{0, 1, 4, 3, 2, 1, 0, 2, 3, 4};
const std::vector<std::int64_t> polygon_ends{3, 7, 10};
const std::vector<std::int64_t> strips{5, 6, 7, 8, 9};
const std::vector<std::int64_t> strip_ends{5};
const std::vector<std::int64_t> lines{0, 1, 2};
const std::vector<std::int64_t> line_ends{3};

/// The coordinates above, and the triangles that the polygons and the strip make.
void expect_the_mesh(const Mesh& mesh, const std::string& file) {
  std::vector<double> found;
  for (const Point& vertex : mesh.vertices) found.insert(found.end(), vertex.begin(), vertex.end());
  EXPECT_EQ(found, coordinates) << file;
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 4}, Triangle{3, 2, 1}, Triangle{3, 1, 0}, Triangle{2, 3, 4},
                                          Triangle{5, 6, 7}, Triangle{7, 6, 8}, Triangle{7, 8, 9}))
      << file;
}

// --- their bytes -------------------------------------------------------------------------------------------------

template <class Number>
std::string bytes(Number number, std::endian order) {
  if (order != std::endian::native) number = reversed_bytes(number);
  const auto array = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  return {array.data(), array.size()};
}

template <class Number, class Given>
std::string bytes(const std::vector<Given>& numbers, std::endian order) {
  std::string result;
  for (const Given number : numbers) result += bytes(static_cast<Number>(number), order);
  return result;
}

template <class Given>
std::string text(const std::vector<Given>& numbers) {
  std::string result;
  for (const Given number : numbers) result += fmt::format("{}{}", number, result.size() % 7 == 0 ? "\n" : " ");
  return result;
}

std::string base64(std::string_view data) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  for (std::size_t at = 0; at < data.size(); at += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (at + k < data.size() ? static_cast<unsigned char>(data[at + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += at + k > data.size() ? '=' : letters[group >> (18U - 6U * k) & 63U];
    }
  }
  return result;
}

std::string packed(std::string_view data) {
  uLongf size = compressBound(data.size());
  std::string result(size, '\0');
  if (compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
               data.size()) != Z_OK) {
    throw std::runtime_error("zlib");
  }
  result.resize(size);
  return result;
}

// --- XML ---------------------------------------------------------------------------------------------------------

struct Form {
  std::string format = "ascii";    ///< of each array
  std::string encoding = "raw";    ///< of the appended part
  std::string number = "Float64";  ///< of coordinates
  std::string index = "Int64";
  std::endian order = std::endian::little;
  bool wide_header = false;
  bool zlib = false;
  bool header_apart = true;  ///< base64 of header and data are two texts
  std::size_t block = 40;    ///< bytes that are packed as one
};

std::string header(const Form& form, const std::vector<std::size_t>& numbers) {
  return form.wide_header ? bytes<std::uint64_t>(numbers, form.order) : bytes<std::uint32_t>(numbers, form.order);
}

/// An array of these bytes.
std::string coded(const Form& form, const std::string& data) {
  std::string head = header(form, {data.size()});
  std::string body = data;
  if (form.zlib) {
    std::vector<std::size_t> numbers{(data.size() + form.block - 1) / form.block, form.block, data.size() % form.block};
    body.clear();
    for (std::size_t at = 0; at < data.size(); at += form.block) {
      const std::string one = packed(std::string_view(data).substr(at, form.block));
      numbers.push_back(one.size());
      body += one;
    }
    head = header(form, numbers);
  }
  if (form.format == "appended" && form.encoding == "raw") return head + body;
  return form.zlib && form.header_apart ? base64(head) + base64(body) : base64(head + body);
}

template <class Given>
std::string array_bytes(const std::string& type, const std::vector<Given>& numbers, std::endian order) {
  if (type == "Float32") return bytes<float>(numbers, order);
  if (type == "Float64") return bytes<double>(numbers, order);
  if (type == "Int32") return bytes<std::int32_t>(numbers, order);
  if (type == "UInt8") return bytes<std::uint8_t>(numbers, order);
  if (type == "UInt16") return bytes<std::uint16_t>(numbers, order);
  if (type == "UInt64") return bytes<std::uint64_t>(numbers, order);
  return bytes<std::int64_t>(numbers, order);
}

class VtpWriter {
 public:
  explicit VtpWriter(Form form) : form_(std::move(form)) {}

  template <class Given>
  std::string array(const std::string& type, const std::string& name, int components,
                    const std::vector<Given>& numbers) {
    std::string result = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format='{}'", type,
                                     name, components, form_.format);
    if (form_.format == "appended") {
      result += fmt::format(" offset=\"{}\" />\n", appended_.size());
      appended_ += coded(form_, array_bytes(type, numbers, form_.order));
      return result;
    }
    const bool ascii = form_.format == "ascii";
    result += ">\n" + (ascii ? text(numbers) : coded(form_, array_bytes(type, numbers, form_.order)));
    return result + "\n<InformationKey name=\"x\"><Value index=\"0\">7 > 2</Value></InformationKey></DataArray>\n";
  }

  std::string cells(const std::string& kind, const std::vector<std::int64_t>& corners,
                    const std::vector<std::int64_t>& ends) {
    return "<" + kind + ">" + array(form_.index, "connectivity", 1, corners) + array(form_.index, "offsets", 1, ends) +
           "</" + kind + ">\n";
  }

  /// A piece with every number above.
  std::string piece() {
    return "<Piece NumberOfPoints=\"10\" NumberOfVerts=\"0\" NumberOfLines=\"1\" NumberOfStrips=\"1\" "
           "NumberOfPolys=\"3\">\n<PointData Scalars=\"a>b\">" +
           array("Float64", "connectivity", 1, coordinates) + "</PointData>\n<Points>" +
           array(form_.number, "Points", 3, coordinates) + "</Points>" + cells("Lines", lines, line_ends) +
           cells("Strips", strips, strip_ends) + cells("Polys", polygons, polygon_ends) + "</Piece>\n";
  }

  [[nodiscard]] std::string file(const std::string& pieces) const {
    std::string result = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"{}\"{}{}>\n"
        "<!-- <Piece> -->\n<PolyData>\n{}</PolyData>\n",
        form_.order == std::endian::big ? "BigEndian" : "LittleEndian",
        form_.wide_header ? " header_type=\"UInt64\"" : "", form_.zlib ? " compressor=\"vtkZLibDataCompressor\"" : "",
        pieces);
    if (!appended_.empty())
      result += "<AppendedData encoding=\"" + form_.encoding + "\">\n _" + appended_ + "\n</AppendedData>\n";
    return result + "</VTKFile>\n";
  }

 private:
  Form form_;
  std::string appended_;
};

std::string vtp(const Form& form) {
  VtpWriter writer(form);
  const std::string piece = writer.piece();
  return writer.file(piece);
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, npos) << from;
  return at == npos ? text : text.replace(at, from.size(), to);
}

Mesh read_vtp(std::string_view contents) {
  return parse_mesh(contents, "mesh.vtp");
}

void expect_vtp_refused(const std::string& contents, const std::string& rest) {
  expect_input_error([&] { (void)read_vtp(contents); }, "mesh.vtp", rest);
}

/// The refusal names the first byte of `place`.
void expect_vtp_refused_at(const std::string& contents, std::string_view place, const std::string& rest) {
  expect_vtp_refused(contents, fmt::format(": byte {}: {}", contents.find(place), rest));
}

std::string name_of(const Form& form) {
  return fmt::format("{} {} {} {} {} {} {} {}", form.format, form.encoding, form.number, form.index,
                     form.order == std::endian::big, form.wide_header, form.zlib, form.header_apart);
}

TEST(Vtp, EveryEncodingGivesTheSameMesh) {
  for (const char* format : {"ascii", "binary", "appended"}) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      for (const unsigned choice : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 10U, 11U, 12U, 13U, 14U, 15U}) {
        Form form{.format = format, .order = order};
        form.wide_header = (choice & 1U) != 0;
        form.zlib = (choice & 2U) != 0;
        if ((choice & 4U) != 0) form.encoding = "base64";
        if ((choice & 8U) != 0) form.number = "Float32";
        form.header_apart = !form.wide_header;
        for (const char* index : {"Int32", "Int64", "UInt8", "UInt16", "UInt64"}) {
          form.index = index;
          expect_the_mesh(read_vtp(vtp(form)), name_of(form));
        }
      }
    }
  }
}

TEST(Vtp, PacksInBlocksOfAnySize) {
  for (const std::size_t block : {1U, 7U, 24U, 80U, 240U, 1000U}) {
    expect_the_mesh(read_vtp(vtp({.format = "binary", .zlib = true, .block = block})), fmt::format("{}", block));
  }
}

TEST(Vtp, WidensFloatsAndReadsTextToTheNearest) {
  const auto x_of = [](const Form& form) {
    VtpWriter writer(form);
    const std::string points = writer.array(form.number, "Points", 3, std::vector<double>{0.1, 0, 0});
    return read_vtp(writer.file("<Piece NumberOfPoints=\"1\"><Points>" + points + "</Points></Piece>")).vertices[0][0];
  };
  EXPECT_EQ(x_of({.format = "binary", .number = "Float32"}), static_cast<double>(0.1F));
  EXPECT_EQ(x_of({.format = "binary"}), 0.1);
  EXPECT_EQ(x_of({.number = "Float32"}), 0.1);
}

TEST(Vtp, ReadsPiecesOneAfterTheOther) {
  for (const char* format : {"ascii", "binary", "appended"}) {
    VtpWriter writer({.format = format});
    const std::string first = writer.piece();
    const std::string empty = "<Piece NumberOfPoints=\"0\" NumberOfPolys=\"0\"/>\n";
    const std::string second = writer.piece();
    const Mesh mesh = read_vtp(writer.file(first + empty + second));
    ASSERT_EQ(mesh.vertices.size(), 20U);
    ASSERT_EQ(mesh.triangles.size(), 14U);
    EXPECT_EQ(mesh.vertices[14], mesh.vertices[4]);
    EXPECT_EQ(mesh.triangles[7], (Triangle{10, 11, 14}));
    EXPECT_EQ(mesh.triangles[13], (Triangle{17, 18, 19}));
  }
}

/// An index of one piece must not reach into another one.
TEST(Vtp, RefusesIndicesOfAnotherPiece) {
  VtpWriter writer({});
  const std::string piece = writer.piece();
  const auto with_strip = [&](const std::string& corner) {
    return replaced(piece, text(strips), text(std::vector<std::int64_t>{5, 6, 7, 8}) + corner);
  };
  const std::string behind = writer.file(with_strip("10") + piece);
  expect_vtp_refused_at(behind, "10\n<Info", "vertex index 10: out of range, the file has 10 vertices, counted from 0");
  const std::string second = writer.file(piece + with_strip("10"));
  expect_vtp_refused_at(second, "10\n<Info",
                        "vertex index 10: out of range, the piece has 10 vertices, counted from 0");
  const std::string before = writer.file(piece + with_strip("-1"));
  expect_vtp_refused_at(before, "-1\n<Info",
                        "vertex index -1: out of range, the piece has 10 vertices, counted from 0");
}

TEST(Vtp, RefusesHeaders) {
  const std::string good = vtp({});
  const auto refused = [&](std::string_view from, std::string_view to, std::string_view place,
                           const std::string& rest) { expect_vtp_refused_at(replaced(good, from, to), place, rest); };
  refused("PolyData\" v", "UnstructuredGrid\" v", "<VTKFile",
          "<VTKFile>: type = 'UnstructuredGrid': only PolyData is a mesh; ParaView makes it of others by Extract "
          "Surface");
  refused("LittleEndian", "Middle", "<VTKFile", "<VTKFile>: byte_order = 'Middle': LittleEndian or BigEndian");
  refused("\"LittleEndian\"", "'BigEndian' header_type='UInt16'", "<VTKFile",
          "<VTKFile>: header_type = 'UInt16': UInt32 or UInt64");
  refused("\"LittleEndian\"", "'BigEndian' compressor='vtkLZ4DataCompressor'", "<VTKFile",
          "<VTKFile>: compressor = 'vtkLZ4DataCompressor': not supported: write the file with vtkZLibDataCompressor "
          "(ZLib), or without a compressor");
  refused("<VTKFile", "<VTK", "<VTK", "<VTK>: expected <VTKFile>");
  refused("<VTKFile type", "<VTKFile version='1' type", "<VTKFile", "not XML: attribute 'version' appears twice");
  refused("<VTKFile type=\"PolyData\"", "<VTKFile type=PolyData", "<VTKFile",
          "<VTKFile>: not XML: attribute 'type' without a value in quotes");
  refused("</Piece>", "</Pieces>", "</Pieces>", "not XML: 'Pieces' ends where it has not begun");
}

TEST(Vtp, RefusesArrays) {
  const std::string good = vtp({});
  const auto refused = [&](std::string_view from, std::string_view to, const std::string& rest) {
    const std::string bad = replaced(good, from, to);
    expect_vtp_refused_at(bad, std::string_view(to).substr(0, 20), rest);
  };
  const std::string points = "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format='ascii'";
  refused(points, "<DataArray type=\"Int64\" Name=\"Points\" NumberOfComponents=\"3\" format='ascii'",
          "<DataArray>: type = 'Int64': coordinates are of Float32 or Float64, indices of integers");
  refused(points, "<DataArray  type=\"Float64\" Name=\"Points\" NumberOfComponents=\"2\" format='ascii'",
          "<DataArray>: NumberOfComponents = '2': expected 3");
  refused(points, "<DataArray  type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format='hex'",
          "<DataArray>: format = 'hex': ascii, binary or appended");
  refused(points, "<DataArray  type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format='appended'",
          "offset is missing");
  refused(points, "<DataArray  type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format='appended' offset='-1'",
          "offset = -1: must not be negative");
  refused("<Piece NumberOfPoints=\"10\"", "<Piece NumberOfPoints=\"ten\"", "NumberOfPoints = 'ten': not an integer");
  expect_vtp_refused(replaced(good, "format='ascii'>\n" + text(polygons), "format='appended' offset='0'>\n"),
                     ": an array is appended, but there is no <AppendedData>");
  expect_vtp_refused(replaced(replaced(good, "<Polys>", "<Pols>"), "</Polys>", "</Pols>"),
                     ": a piece without the DataArray of its offsets");
  expect_vtp_refused(replaced(replaced(good, "<PolyData>", "<Polys>"), "</PolyData>", "</Polys>"),
                     ": no <Piece> of <PolyData>");
  EXPECT_THAT([&] { (void)read_vtp(replaced(good, "NumberOfPoints=\"10\"", "NumberOfPoints=\"9\"")); },
              ::testing::ThrowsMessage<Error>(::testing::EndsWith("more numbers than the piece has")));
}

TEST(Vtp, RefusesNumbersThatAreNoSurface) {
  const auto refused = [](const std::vector<std::int64_t>& corners, const std::vector<std::int64_t>& ends,
                          const std::string& rest) {
    for (const char* format : {"ascii", "binary"}) {
      VtpWriter writer({.format = format});
      const std::string points = writer.array("Float64", "Points", 3, coordinates);
      const std::string file =
          writer.file(fmt::format("<Piece NumberOfPoints=\"10\" NumberOfPolys=\"{}\"><Points>{}</Points>{}</Piece>",
                                  ends.size(), points, writer.cells("Polys", corners, ends)));
      try {
        (void)read_vtp(file);
        ADD_FAILURE() << rest;
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(rest));
      }
    }
  };
  refused({0, 1}, {2}, "number of corners = 2: a face needs at least 3");
  refused({0, 1, 2, 3}, {3, 2}, "offset 2 behind offset 3");
  refused({0, 1, 2, 3}, {3, -2}, "offset -2 behind offset 3");
  refused({0, 1, 10}, {3}, "vertex index 10: out of range, the file has 10 vertices, counted from 0");
  refused({0, 1, -1}, {3}, "vertex index -1: out of range, the file has 10 vertices, counted from 0");
  refused({0, 1, 1}, {3},
          "triangle 1 names a vertex twice, and its line from (0, 0, 0) to (1, 0, 0) is no side of another triangle: "
          "leave it out");
  refused({0, 1, 4, 0, 2, 1, 3}, {3, 7}, "face 2: its outline crosses or touches itself");
}

TEST(Vtp, RefusesCoordinatesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const char* format : {"ascii", "binary", "appended"}) {
    VtpWriter writer({.format = format});
    const std::string points = writer.array("Float64", "Points", 3, std::vector<double>{0, nan, 0});
    const std::string file = writer.file("<Piece NumberOfPoints=\"1\"><Points>" + points + "</Points></Piece>");
    EXPECT_THAT([&] { (void)read_vtp(file); },
                ::testing::ThrowsMessage<Error>(::testing::EndsWith(": not a finite number")));
  }
}

/// Nothing is missing at any place without being noticed.
TEST(Vtp, RefusesEveryBeginningOfAFile) {
  const std::vector<Form> forms{{},
                                {.format = "binary"},
                                {.format = "binary", .zlib = true},
                                {.format = "appended"},
                                {.format = "appended", .zlib = true},
                                {.format = "appended", .encoding = "base64", .zlib = true}};
  for (const Form& form : forms) {
    const std::string whole = vtp(form);
    for (std::size_t size = 1; size + 1 < whole.size(); ++size) {
      EXPECT_THROW((void)read_vtp(std::string_view(whole).substr(0, size)), Error) << name_of(form) << size;
    }
    EXPECT_THROW((void)read_vtp(whole + "x"), Error) << name_of(form);
  }
}

TEST(Vtp, RefusesSizesThatTheFileDoesNotHold) {
  const auto header_of = [](const std::vector<std::uint64_t>& numbers, bool zlib) {
    Form form{.format = "binary", .wide_header = true, .zlib = zlib};
    const std::string data = base64(bytes<std::uint64_t>(numbers, std::endian::little));
    const VtpWriter writer(form);
    const std::uint64_t points = zlib ? 3'000'000'000'000'000'000U : numbers[0] / 24;
    return writer.file(
        fmt::format("<Piece NumberOfPoints=\"{}\"><Points><DataArray type=\"Float64\" "
                    "NumberOfComponents=\"3\" format=\"binary\">{}</DataArray></Points></Piece>",
                    zlib ? std::clamp<std::uint64_t>(numbers[0] * numbers[1] / 24, 1, points) : points, data));
  };
  const auto refused = [&](const std::vector<std::uint64_t>& numbers, bool zlib, const std::string& rest) {
    EXPECT_THAT([&] { (void)read_vtp(header_of(numbers, zlib)); }, ::testing::ThrowsMessage<Error>(HasSubstr(rest)));
  };
  refused({std::uint64_t{24} << 40U}, false, "Points: truncated: 26388279066624 bytes, the file has ");
  refused({std::uint64_t{1} << 63U}, false, "Points: its header has 9223372036854775808");
  refused({25}, false, "Points: 25 bytes, expected 1 times 24");
  refused({1, 24 << 20U, 0, 8}, true, "truncated: 25165824 bytes packed into 8");
  refused({1, 24, 0, std::uint64_t{1} << 50U}, true, "truncated: 24 bytes packed into 1125899906842624");
  refused({std::uint64_t{1} << 30U, 24, 0, 8}, true, "Points: '<' is no letter of base64 here");
  refused({std::uint64_t{1} << 40U, 24, 0, 8}, true, "packed blocks of 24 bytes, the last one of 0");
  refused({1, 24, 25, 8}, true, "Points: 1 packed blocks of 24 bytes, the last one of 25");
  refused({1, 0, 0, 8}, true, "Points: 1 packed blocks of 0 bytes");
}

TEST(Vtp, RefusesWhatDoesNotUnpack) {
  const std::string good = vtp({.format = "appended", .zlib = true, .block = 240});
  std::string bad = good;  // in every block, behind zlib's first bytes
  for (std::size_t at = 0; (at = bad.find("\x78\x9c", at)) != npos; at += 2) {
    bad[at + 5] = static_cast<char>(bad[at + 5] ^ 0x55);
  }
  EXPECT_THAT([&] { (void)read_vtp(bad); }, ::testing::ThrowsMessage<Error>(HasSubstr("does not unpack to ")));
}

TEST(Vtp, RefusesWhatIsNoBase64) {
  const std::string good = vtp({.format = "binary"});
  const std::size_t at = good.find("Name=\"Points\"");
  const std::size_t letters = good.find('\n', at) + 1;
  for (const std::string_view wrong : {"*", "=", "A=", "AA=A"}) {
    std::string bad = good;
    bad.replace(letters + 40, wrong.size(), wrong);
    EXPECT_THAT([&] { (void)read_vtp(bad); },
                ::testing::ThrowsMessage<Error>(HasSubstr(" is no letter of base64 here")))
        << wrong;
  }
}

TEST(Vtp, RefusesOffsetsBeyondTheAppendedData) {
  const std::string good = vtp({.format = "appended"});
  const std::size_t at = good.find("offset=", good.find("Name=\"Points\""));
  const std::size_t end = good.find('"', at + 8);
  const auto with_offset = [&](const std::string& offset) {
    return good.substr(0, at) + "offset=\"" + offset + good.substr(end);
  };
  expect_vtp_refused(with_offset("9223372036854775807"),
                     ": Points: offset = 9223372036854775807: beyond the end of the file");
  expect_vtp_refused(replaced(good, "</AppendedData>\n", ""),
                     ": truncated, or longer: it does not end with </AppendedData></VTKFile>");
  expect_vtp_refused_at(replaced(good, "\"raw\"", "\"hex\""), "<AppendedData",
                        "<AppendedData>: encoding = 'hex': raw or base64");
  expect_vtp_refused_at(replaced(good, "\n _", "\n #"), "#", "the appended data do not begin with '_'");
}

// --- the legacy form ---------------------------------------------------------------------------------------------

struct LegacyForm {
  bool binary = false;
  bool arrays = false;  ///< of cells, as since version 5.1
  std::string number = "double";
  std::string index = "vtktypeint64";
};

/// Each cell's number of corners, then its corners.
std::vector<std::int64_t> inline_cells(const std::vector<std::int64_t>& corners,
                                       const std::vector<std::int64_t>& ends) {
  std::vector<std::int64_t> result;
  std::int64_t start = 0;
  for (const std::int64_t end : ends) {
    result.push_back(end - start);
    result.insert(result.end(), corners.begin() + start, corners.begin() + end);
    start = end;
  }
  return result;
}

template <class Given>
std::string legacy_numbers(const LegacyForm& form, const std::string& type, const std::vector<Given>& numbers) {
  if (!form.binary) return text(numbers) + "\n";
  if (type == "float") return bytes<float>(numbers, std::endian::big) + "\n";
  if (type == "double") return bytes<double>(numbers, std::endian::big) + "\n";
  if (type == "vtktypeint64") return bytes<std::int64_t>(numbers, std::endian::big) + "\n";
  if (type == "unsigned_char") return bytes<std::uint8_t>(numbers, std::endian::big) + "\n";
  return bytes<std::int32_t>(numbers, std::endian::big) + "\n";
}

std::string legacy_cells(const LegacyForm& form, const std::string& keyword, const std::vector<std::int64_t>& corners,
                         const std::vector<std::int64_t>& ends) {
  if (!form.arrays) {
    const std::vector<std::int64_t> cells = inline_cells(corners, ends);
    return fmt::format("{} {} {}\n{}", keyword, ends.size(), cells.size(), legacy_numbers(form, "int", cells));
  }
  std::vector<std::int64_t> offsets{0};
  offsets.insert(offsets.end(), ends.begin(), ends.end());
  return fmt::format("{} {} {}\nOFFSETS {}\n{}CONNECTIVITY {}\n{}", keyword, offsets.size(), corners.size(), form.index,
                     legacy_numbers(form, form.index, offsets), form.index, legacy_numbers(form, form.index, corners));
}

const std::string metadata = "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1.75 \n\n";

std::string legacy_start(const LegacyForm& form) {
  return fmt::format("# vtk DataFile Version {}\na title\n{}\nDATASET POLYDATA\n", form.arrays ? "5.1" : "4.2",
                     form.binary ? "BINARY" : "ASCII");
}

std::string legacy_points(const LegacyForm& form) {
  return fmt::format("POINTS 10 {}\n{}", form.number, legacy_numbers(form, form.number, coordinates));
}

/// Up to the attributes.
std::string legacy_geometry(const LegacyForm& form) {
  const std::vector<std::int64_t> times{1, 2, 3, 4};
  return legacy_start(form) + "FIELD FieldData 2\nTimeValue 2 2 double\n" + legacy_numbers(form, "double", times) +
         metadata + "Another 1 4 unsigned_char\n" + legacy_numbers(form, "unsigned_char", times) + legacy_points(form) +
         metadata + legacy_cells(form, "VERTICES", {0, 1}, {1, 2}) + legacy_cells(form, "LINES", lines, line_ends) +
         legacy_cells(form, "POLYGONS", polygons, polygon_ends) +
         legacy_cells(form, "TRIANGLE_STRIPS", strips, strip_ends);
}

std::string legacy(const LegacyForm& form) {
  return legacy_geometry(form) + "\nCELL_DATA 8\nPOINT_DATA 10\nSCALARS whatever this is\n";
}

Mesh read_legacy(std::string_view contents) {
  return parse_mesh(contents, "mesh.vtk");
}

void expect_legacy_refused_at(const std::string& contents, std::string_view place, const std::string& rest) {
  expect_input_error([&] { (void)read_legacy(contents); }, "mesh.vtk",
                     fmt::format(": byte {}: {}", contents.find(place), rest));
}

TEST(LegacyVtk, EveryEncodingGivesTheSameMesh) {
  for (const bool binary : {false, true}) {
    for (const bool arrays : {false, true}) {
      for (const char* number : {"float", "double"}) {
        for (const char* index : {"vtktypeint64", "int", "unsigned_char"}) {
          const LegacyForm form{binary, arrays, number, index};
          const std::string name = fmt::format("{} {} {} {}", binary, arrays, number, index);
          expect_the_mesh(read_legacy(legacy(form)), name);
          expect_the_mesh(read_legacy(legacy_geometry(form)), name);
        }
      }
    }
  }
}

TEST(LegacyVtk, KeywordsInAnyCase) {
  std::string file = "# vtk DataFile Version 2.0\n\nascii\ndataset PolyData\npoints 3 Float\n0 0 0 1 0 0\r\n0 1 0\n";
  file += "Polygons 1 4 3\n0 1 2";
  EXPECT_THAT(read_legacy(file).triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_TRUE(read_legacy(file.substr(0, file.find("Polygons"))).triangles.empty());
}

TEST(LegacyVtk, RefusesHeaders) {
  const std::string good = legacy({});
  const auto refused = [&](std::string_view from, std::string_view to, const std::string& rest) {
    expect_legacy_refused_at(replaced(good, from, to), to, rest);
  };
  refused("# vtk", "vtk", "not a VTK file: the first line must be '# vtk DataFile Version ...'");
  refused("ASCII", "TEXT", "'text': expected ASCII or BINARY");
  refused("DATASET", "DATA", "'data': expected 'dataset'");
  refused("POLYDATA", "UNSTRUCTURED_GRID",
          "DATASET UNSTRUCTURED_GRID: only POLYDATA is a mesh; ParaView makes it of others by Extract Surface");
  refused("LINES", "CURVES", "keyword 'curves': not one of POLYDATA");
  EXPECT_THAT([&] { (void)read_legacy(replaced(good, "LINES", "POINTS")); },
              ::testing::ThrowsMessage<Error>(::testing::EndsWith(": POINTS a second time")));
  refused("10 double", "-3 double", "number of points = -3: must not be negative");
  refused("10 double", "x double", "number of points = 'x': not an integer");
}

TEST(LegacyVtk, RefusesNumbersThatAreNoSurface) {
  const auto refused = [](const std::vector<std::int64_t>& corners, const std::vector<std::int64_t>& ends,
                          const std::string& rest) {
    for (const bool binary : {false, true}) {
      for (const bool arrays : {false, true}) {
        const LegacyForm form{binary, arrays};
        const std::string file =
            legacy_start(form) + legacy_points(form) + legacy_cells(form, "POLYGONS", corners, ends);
        EXPECT_THAT([&] { (void)read_legacy(file); }, ::testing::ThrowsMessage<Error>(::testing::EndsWith(rest)));
      }
    }
  };
  refused({0, 1}, {2}, "number of corners = 2: a face needs at least 3");
  refused({0, 1, 10}, {3}, "vertex index 10: out of range, the file has 10 vertices, counted from 0");
  refused({0, 1, -1}, {3}, "vertex index -1: out of range, the file has 10 vertices, counted from 0");
  refused({0, 1, 1}, {3},
          "triangle 1 names a vertex twice, and its line from (0, 0, 0) to (1, 0, 0) is no side of another triangle: "
          "leave it out");
}

TEST(LegacyVtk, RefusesSizesThatDoNotFit) {
  const std::string start = legacy_start({}) + legacy_points({});
  const auto refused = [&](const std::string& cells, const std::string& rest) {
    EXPECT_THAT([&] { (void)read_legacy(start + cells); }, ::testing::ThrowsMessage<Error>(::testing::EndsWith(rest)))
        << cells;
  };
  refused("POLYGONS 1 5\n3 0 1 2\n", "size of the cells = 5: it is 4");
  refused("POLYGONS 2 8\n3 0 1 2\n", "number of corners is missing");
  refused("POLYGONS 1 4\n4 0 1 2\n", "vertex index is missing");
  refused("POLYGONS 1 4\n3 0 1 2 3\n", "keyword '3': not one of POLYDATA");
  refused("POLYGONS 2 3\nOFFSETS int\n0 3\nCONNECTIVITY int\n0 1\n", "vertex index is missing");
  refused("POLYGONS 2 4\nOFFSETS int\n0 3\nCONNECTIVITY int\n0 1 2 3\n", "the last offset is 3, not 4");
  refused("POLYGONS 2 3\nOFFSETS int\n1 3\nCONNECTIVITY int\n0 1 2\n", "the first offset must be 0");
  refused("POLYGONS 2 3\nOFFSETS float\n0 3\nCONNECTIVITY int\n0 1 2\n", "offsets are integers");
  refused("POLYGONS 2 3\nOFFSETS bit\n0 3\nCONNECTIVITY int\n0 1 2\n", "type 'bit': not read");
  refused("POLYGONS 2 3\nOFFSETS int\n0 3\n0 1 2\n", "'0': expected 'connectivity'");
  refused("LINES 1 9000000000000000000\n2 0 1\n", "truncated: the file ends inside cells");
  refused("FIELD f 1\nx 4000000000 4000000000 double\n1\n", "truncated: the field has more numbers");
  refused("FIELD f 9000000000000000000\n", "number of components is missing");
  EXPECT_EQ(read_legacy(start + "FIELD f 1\nx 0 9000000000000000000 double\n").vertices.size(), 10U);
}

TEST(LegacyVtk, RefusesEveryBeginningOfAFile) {
  for (const bool binary : {false, true}) {
    for (const bool arrays : {false, true}) {
      const std::string whole = legacy_geometry({binary, arrays});
      const std::size_t cells = whole.find("TRIANGLE_STRIPS");  // before it, a file may end between two sections
      for (std::size_t size = 1; size + 2 < whole.size(); ++size) {
        try {
          const Mesh mesh = read_legacy(std::string_view(whole).substr(0, size));
          EXPECT_LE(size, cells) << whole.substr(0, size);
          EXPECT_TRUE(mesh.triangles.empty() || mesh.triangles.size() == 4) << size;
          EXPECT_EQ(mesh.vertices.size(), 10U) << size;
        } catch (const Error& error) {
          EXPECT_EQ(error.kind(), ErrorKind::input);
        }
      }
    }
  }
}

}  // namespace
}  // namespace verisq
