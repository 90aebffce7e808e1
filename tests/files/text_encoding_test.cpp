/// The encodings of text files: every reader skips the byte order mark of UTF-8, and refuses UTF-16 and UTF-32 by name.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <functional>
#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>
#include <verisq/stance.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::TemporaryFolder;
using Path = std::filesystem::path;

std::string sizes(const Mesh& mesh) {
  return fmt::format("{} vertices, {} triangles", mesh.vertices.size(), mesh.triangles.size());
}

struct TextFormat {
  std::string name;
  std::string text;                              ///< of a file, or the beginning of one: then messages are compared
  std::function<std::string(const Path&)> read;  ///< something that depends on all that was read
};

void PrintTo(const TextFormat& format, std::ostream* stream) {
  *stream << format.name;
}

std::string mesh_sizes(const Path& path) {
  return sizes(read_mesh(path));
}

std::string point_sum(const Path& path) {
  PointFile file(path);
  std::vector<Point> points(10);
  const std::size_t count = file.read(points);
  return fmt::format("{} points, {}", count, points[0][0]);
}

std::string label_count(const Path& path) {
  return fmt::format("{} labels", read_label_volume(path).labels.size());
}

std::string row_count(const Path& path) {
  std::vector<CertifiedRow> rows(10);
  return fmt::format("{} rows", MapReader(path).read(rows));
}

/// What .part.json has beside a map.
std::string part(const Path& path) {
  return fmt::format("{} rows", read_map_part(path.parent_path() / path.stem().stem()).rows.count);
}

const std::string solid = R"({"format":"verisq-model/1","primitives":[{"name":"a","superquadric":
  {"semi_axes":[1,2,3],"exponents":[1,0.5]}}]})";

const std::vector<TextFormat> formats{
    {"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n", mesh_sizes},
    {"m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", mesh_sizes},
    {"m.ply",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
     "3\n",
     mesh_sizes},
    {"m.stl", "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
     mesh_sizes},
    {"p.xyz", "1 2 3\n4 5 6\n", point_sum},
    {"p.csv", "x,y,z\n1,2,3\n4,5,6\n", point_sum},
    {"poses.csv", "1,2,3,1,0,0,0\n", [](const Path& path) { return fmt::format("{} poses", read_poses(path).size()); }},
    {"m.json", solid, [](const Path& path) { return read_model(path).primitives.at(0).name; }},
    {"uncertain.json", solid, [](const Path& path) { return read_uncertain_model(path).primitives.at(0).name; }},
    {"l.json", R"({"format":"verisq-landmarks/1","head_radius":24,"landmarks":{}})",
     [](const Path& path) { return fmt::format("{}", *read_landmarks(path).landmarks.head_radius); }},
    {"c.json", R"({"format":"verisq-certificate/1","kind":"none"})",
     [](const Path& path) { return fmt::format("{}", read_answer(path).index()); }},
    {"m.csv.part.json", R"({"format":"other"})", part},
    {"s.xml",
     R"(<stance gravity="0"><applied_force><frequency value="0"/><force x="0" y="0" z="0"/></applied_force><body name="a"><rotation name="r" axis="x"/><mass value="1"/><centre_of_mass x="0" y="0" z="0"/><inertia x="0" y="0" z="0"/></body></stance>)",
     [](const Path& path) { return fmt::format("{} bodies", stance::read_model(path).bodies.size()); }},
    {"m.csv",
     "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z\n"
     "1,-inf,inf,wide,,,,,,,,\n",
     row_count},
    {"m.vtp", R"(<VTKFile type="PolyData"><AppendedData encoding="raw">_)", row_count},
    {"v.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspacings: 1 1 1\nencoding: raw\n\n\x01\x02",
     label_count},
};

std::string in_units(const std::string& text, std::size_t bytes, std::size_t place) {
  std::string result(text.size() * bytes, '\0');
  for (std::size_t k = 0; k < text.size(); ++k) result[k * bytes + place] = text[k];
  return result;
}

class TextEncoding : public ::testing::TestWithParam<TextFormat> {
 protected:
  /// What was read, or the message.
  [[nodiscard]] std::string outcome(const std::string& bytes) const {
    try {
      return GetParam().read(folder_.file(GetParam().name, bytes));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
  }

  [[nodiscard]] std::string refusal(const std::string& encoding) const {
    return (folder_ / GetParam().name).string() + ": is text in " + encoding + ": save it as UTF-8 or ASCII";
  }

 private:
  TemporaryFolder folder_;
};

TEST_P(TextEncoding, MarkOfUtf8IsNoText) {
  EXPECT_EQ(outcome("\xEF\xBB\xBF" + GetParam().text), outcome(GetParam().text));
}

TEST_P(TextEncoding, WiderOnesAreRefusedByName) {
  struct Wide {
    std::string name;
    std::string mark;
    std::size_t bytes;
    std::size_t place;
  };
  const std::array<Wide, 4> wide{{{"UTF-16 (little-endian)", "\xFF\xFE", 2, 0},
                                  {"UTF-16 (big-endian)", "\xFE\xFF", 2, 1},
                                  {"UTF-32 (little-endian)", std::string("\xFF\xFE\0\0", 4), 4, 0},
                                  {"UTF-32 (big-endian)", std::string("\0\0\xFE\xFF", 4), 4, 3}}};
  for (const auto& [name, mark, bytes, place] : wide) {
    const std::string text = in_units(GetParam().text, bytes, place);
    EXPECT_EQ(outcome(mark + text), refusal(name));
    EXPECT_EQ(outcome(text), refusal(name)) << "without a mark";
  }
}

TEST_P(TextEncoding, PointersToFilesAreNoFiles) {
  const std::string message = outcome("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 381\n");
  EXPECT_THAT(message, ::testing::HasSubstr("is a pointer of Git LFS, not the file that it stands for"));
}

INSTANTIATE_TEST_SUITE_P(Reader, TextEncoding, ::testing::ValuesIn(formats), [](const auto& instance) {
  std::string name = instance.param.name;
  std::ranges::replace(name, '.', '_');
  return name;
});

/// A binary STL may begin with any bytes.
TEST(TextEncodingOfBinaryFiles, IsNotAsked) {
  const TemporaryFolder folder;
  for (const std::string mark : {"\xEF\xBB\xBF", "\xFF\xFE"}) {
    std::string bytes = mark;
    bytes.resize(80, ' ');
    bytes += std::string("\1\0\0\0", 4) + std::string(12, '\0');
    const std::string one("\0\0\x80\x3f", 4);
    const std::string zero(4, '\0');
    bytes += zero + zero + zero + one + zero + zero + zero + one + zero + std::string(2, '\0');
    EXPECT_EQ(mesh_sizes(folder.file("b.stl", bytes)), "3 vertices, 1 triangles");
    EXPECT_EQ(mesh_sizes(folder.file("b.stl", bytes + "\n")), "3 vertices, 1 triangles");
  }
}

}  // namespace
}  // namespace verisq
