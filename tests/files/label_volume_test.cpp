/// Labelled volumes: where their voxels lie, types, packings, and the message for every file that is refused.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "tests/fixtures/volume_files.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using testing::gzipped;
using testing::NiftiFile;
using testing::NrrdFile;
using testing::TemporaryFolder;
using testing::volume_bytes;

const std::vector<int> six_labels{0, 1, 2, 300, 65535, 1};

class LabelVolumes : public ::testing::Test {
 protected:
  [[nodiscard]] LabelVolume read(const std::string& name, const std::string& bytes) const {
    return read_label_volume(folder_.file(name, bytes));
  }
  void expect_refusal(const std::string& name, const std::string& bytes, const std::string& message) const {
    const auto path = folder_.file(name, bytes);
    expect_input_error([&] { (void)read_label_volume(path); }, path, ": " + message);
  }

  TemporaryFolder folder_;
};

// --- NRRD ------------------------------------------------------------------------------------------------------------

TEST_F(LabelVolumes, OfSlicerLieWhereTheFileSays) {
  const NrrdFile file{.type = "unsigned short",
                      .sizes = "3 2 1",
                      .directions = "(0.5,0,0) (0,0,-2) (0,1.5,0)",
                      .origin = "(-10,20.25,3e1)"};
  const LabelVolume volume = read("labels.NRRD", file.header() + volume_bytes<std::uint16_t>(six_labels));
  EXPECT_THAT(volume.counts, ElementsAre(3U, 2U, 1U));
  EXPECT_EQ(volume.origin, (Point{-10, 20.25, 30}));
  EXPECT_THAT(volume.steps, ElementsAre(Point{0.5, 0, 0}, Point{0, 0, -2}, Point{0, 1.5, 0}));
  EXPECT_EQ(volume.space, AnatomicalSpace::lps);
  EXPECT_THAT(volume.labels, ElementsAre(0, 1, 2, 300, 65535, 1));
  EXPECT_DOUBLE_EQ(voxel_volume(volume), 1.5);
}

TEST_F(LabelVolumes, ComeInLpsWhateverTheFileIsIn) {
  const std::string voxels = volume_bytes<std::int16_t>({0, 1});
  const std::string directions = "(1,2,3) (-4,5,6) (7,8,-9)";
  const auto in = [&](const std::string& space) {
    return read("a.nrrd", NrrdFile{.space = space, .directions = directions, .origin = "(10,20,30)"}.header() + voxels);
  };
  EXPECT_EQ(in("RAS").origin, (Point{-10, -20, 30}));
  EXPECT_EQ(in("RAS").steps[1], (Point{4, -5, 6}));
  EXPECT_EQ(in("right-anterior-superior").origin, (Point{-10, -20, 30}));
  EXPECT_EQ(in("left-anterior-superior").steps[2], (Point{7, -8, -9}));
  EXPECT_EQ(in("LPS").steps[2], (Point{7, 8, -9}));
  EXPECT_EQ(in("scanner-xyz").space, AnatomicalSpace::unknown);
  EXPECT_EQ(in("scanner-xyz").origin, (Point{10, 20, 30}));
  EXPECT_EQ(in_space(in("LPS"), AnatomicalSpace::ras).origin, (Point{-10, -20, 30}));
  EXPECT_EQ(in_space(in("RAS"), AnatomicalSpace::lps).origin, (Point{-10, -20, 30}));
}

TEST_F(LabelVolumes, WithoutASpaceHaveTheirSpacings) {
  NrrdFile file{.space = "", .directions = "", .origin = "", .more = "spacings: 0.5 2 3\n"};
  const LabelVolume volume = read("a.nrrd", file.header() + volume_bytes<std::int16_t>({0, 1}));
  EXPECT_EQ(volume.space, AnatomicalSpace::unknown);
  EXPECT_THAT(volume.steps, ElementsAre(Point{0.5, 0, 0}, Point{0, 2, 0}, Point{0, 0, 3}));
}

TEST_F(LabelVolumes, OfNrrdAreInMillimetres) {
  NrrdFile file{.space = "RAS", .origin = "(1,2,3)", .more = "space units: \"cm\" \"cm\" \"cm\"\n"};
  const LabelVolume volume = read("a.nrrd", file.header() + volume_bytes<std::int16_t>({0, 1}));
  EXPECT_EQ(volume.origin, (Point{-10, -20, 30}));
  EXPECT_EQ(volume.steps[2], (Point{0, 0, 10}));
}

template <class Number>
void expect_type(const TemporaryFolder& folder, const std::string& type) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const bool packed : {false, true}) {
      NrrdFile file{.type = type,
                    .sizes = "1 1 3",
                    .endian = order == std::endian::little ? "little" : "big",
                    .encoding = packed ? "gzip" : "raw"};
      const std::string voxels = volume_bytes<Number>({0, 7, 127}, order);
      const auto path = folder.file("typed.nrrd", file.header() + (packed ? gzipped(voxels) : voxels));
      EXPECT_THAT(read_label_volume(path).labels, ElementsAre(0, 7, 127)) << type;
    }
  }
}

TEST_F(LabelVolumes, MayHaveAnyTypeOfNumber) {
  expect_type<std::int8_t>(folder_, "signed char");
  expect_type<std::uint8_t>(folder_, "uchar");
  expect_type<std::int16_t>(folder_, "short");
  expect_type<std::uint16_t>(folder_, "uint16");
  expect_type<std::int32_t>(folder_, "int");
  expect_type<std::uint32_t>(folder_, "unsigned int");
  expect_type<std::int64_t>(folder_, "long long");
  expect_type<std::uint64_t>(folder_, "uint64_t");
  expect_type<float>(folder_, "float");
  expect_type<double>(folder_, "double");
}

TEST_F(LabelVolumes, MayBePackedInSeveralMembers) {
  const std::string voxels = volume_bytes<std::int16_t>(std::vector<int>(200'000, 9));
  const NrrdFile file{.sizes = "200 100 10", .encoding = "gz"};
  const std::string packed = gzipped(voxels.substr(0, 131'071)) + gzipped(voxels.substr(131'071));
  EXPECT_THAT(labels_of(read("a.nrrd", file.header() + packed)),
              ElementsAre(::testing::FieldsAre(std::uint16_t{9}, std::uint64_t{200'000})));
}

TEST_F(LabelVolumes, OfNrrdAreRefusedInOneLine) {
  const std::string voxels = volume_bytes<std::int16_t>({0, 1});
  const auto expect = [&](const NrrdFile& file, const std::string& message) {
    expect_refusal("a.nrrd", file.header() + voxels, message);
  };
  expect_refusal("a.nrrd", "NRRX", "line 1: does not begin with NRRD000");
  expect_refusal("a.mha", "NRRD", "volumes are read from .nrrd, .nii and .nii.gz");
  expect_refusal("a.nrrd", "NRRD0004\ntype: short\n", "line 2: truncated: the file ends inside its header");
  expect({.type = "block"}, "line 3: type 'block': not supported, integers and floats are");
  expect({.dimension = "4"},
         "line 4: dimension = 4: must be 3, one label a voxel (segments that overlap lie in layers: export them as a "
         "label "
         "map)");
  expect({.sizes = "2 1"}, "line 6: size is missing");
  expect({.sizes = "3 1 1"}, "3 x 1 x 1 voxels of 2 bytes: more than a file of 271 bytes can hold");
  expect({.sizes = "1 1 1"}, "there are more bytes after the last voxel");
  expect({.sizes = "2 0 1"}, "0 voxels along an axis: must be positive");
  expect({.sizes = "2000000000 2000000000 2000000000"},
         "2000000000 x 2000000000 x 2000000000 voxels of 2 bytes: more than a file of 298 bytes can hold");
  expect({.directions = "(1,0,0) (2,0,0) (0,0,1)"}, "its axes span no volume: the size of a voxel is 0");
  expect({.directions = "none (1,0,0) (2,0,0)"},
         "line 7: space directions: expected (x,y,z), found 'none (1,0,0) (2,0,0)'");
  expect({.origin = "(1,2)"}, "line 10: space origin: a vector has other than three numbers");
  expect({.endian = ""}, "its header has no endian");
  expect({.encoding = "bzip2"}, "line 9: encoding 'bzip2': not supported, raw and gzip are");
  expect({.more = "data file: labels.raw\n"}, "line 11: data file: the voxels must be in the same file");
  expect({.more = "type: short\n"}, "line 11: 'type' appears twice");
  expect({.more = "spacings: 2 2 2\n"},
         "line 12: spacings and space directions contradict each other: one of them says how far voxels are apart");
  expect({.space = "", .directions = "", .origin = "", .more = "spacings: 1 -1 1\n"},
         "line 8: spacing = '-1': must be above 0");
  expect({.more = "space units: \"in\" \"in\" \"in\"\n"},
         "line 11: units '\"in\" \"in\" \"in\"': must be \"mm\", \"cm\", \"m\" or \"um\"");
  expect({.directions = "(1e-100,0,0) (0,1e-100,0) (0,0,1e-100)"},
         "a voxel is 1e-100 long along axis 0: must be 1e-09 to 1000000000");
  expect({.directions = "(1,0,0) (0,1,0) (0,0,1e4)"},
         "its voxels are 10000 times as long as wide: at most 100 is supported");
  expect({.directions = "(1,0,0) (1,1e-6,0) (0,0,1)"}, "its axes span no volume: the size of a voxel is 1e-06");
  expect({.encoding = "gzip"}, "gzip data near byte 268: incorrect header check");
  expect_refusal("a.nrrd", NrrdFile{}.header() + volume_bytes<std::int16_t>({1, -1}),
                 "voxel 1 (from 0) is -1: labels are integers from 0 to 65535");
  const std::string packed = gzipped(voxels);
  expect_refusal("a.nrrd", NrrdFile{.encoding = "gzip"}.header() + packed.substr(0, packed.size() - 9),
                 "truncated: the file ends inside its gzip data");
}

// --- NIfTI -----------------------------------------------------------------------------------------------------------

TEST_F(LabelVolumes, OfNiftiComeInLps) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    NiftiFile file({3, 2, 1}, order);
    file.affine({{{0.5F, 0, 0, 10}, {0, 2, 0, -20}, {0, 0, 3, 30}}});
    const std::string bytes = file.header() + volume_bytes<std::int16_t>({0, 1, 2, 3, 4, 5}, order);
    for (const auto& [name, contents] : {std::pair{"a.nii", bytes}, std::pair{"a.nii.gz", gzipped(bytes)}}) {
      const LabelVolume volume = read(name, contents);
      EXPECT_THAT(volume.counts, ElementsAre(3U, 2U, 1U));
      EXPECT_EQ(volume.space, AnatomicalSpace::lps);
      EXPECT_EQ(volume.origin, (Point{-10, 20, 30}));
      EXPECT_THAT(volume.steps, ElementsAre(Point{-0.5, 0, 0}, Point{0, -2, 0}, Point{0, 0, 3}));
      EXPECT_THAT(volume.labels, ElementsAre(0, 1, 2, 3, 4, 5));
    }
  }
}

TEST_F(LabelVolumes, OfNiftiMayBeTurnedByAQuaternion) {
  NiftiFile file({2, 1, 1}, std::endian::little);
  // A quarter turn about x, the third axis turned over: the second axis points along z, the third along y.
  file.set<std::int16_t>(252, 1).set<float>(256, static_cast<float>(std::sqrt(0.5)));
  file.set<float>(76, -1.0F).set<float>(80, 2.0F).set<float>(84, 3.0F).set<float>(88, 4.0F);
  file.set<float>(268, 7.0F).set<float>(272, 8.0F).set<float>(276, 9.0F);
  const LabelVolume volume = read("a.nii", file.header() + volume_bytes<std::int16_t>({0, 1}));
  EXPECT_EQ(volume.origin, (Point{-7, -8, 9}));
  const std::array<Point, 3> steps{Point{-2, 0, 0}, Point{0, 0, 3}, Point{0, -4, 0}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t row = 0; row < 3; ++row) EXPECT_NEAR(volume.steps[axis][row], steps[axis][row], 1e-6);
}

TEST_F(LabelVolumes, OfNiftiAreInMillimetres) {
  NiftiFile file({2, 1, 1}, std::endian::little);
  file.set<float>(80, 0.5F).set<std::uint8_t>(123, 1);
  const LabelVolume volume = read("a.nii", file.header() + volume_bytes<std::int16_t>({0, 1}));
  EXPECT_EQ(volume.space, AnatomicalSpace::unknown);
  EXPECT_EQ(volume.steps[0], (Point{500, 0, 0}));
}

TEST_F(LabelVolumes, OfNiftiWithoutASlopeAreNotScaled) {
  for (const float slope : {0.0F, 1.0F, std::nanf("")}) {
    NiftiFile file({2, 1, 1}, std::endian::little);
    file.set<float>(112, slope);
    EXPECT_THAT(read("a.nii", file.header() + volume_bytes<std::int16_t>({7, 9})).labels, ElementsAre(7, 9));
  }
}

TEST_F(LabelVolumes, OfNiftiAreRefusedInOneLine) {
  const std::string voxels = volume_bytes<std::int16_t>({0, 1});
  const auto expect = [&](const auto& change, const std::string& message) {
    NiftiFile file({2, 1, 1}, std::endian::little);
    change(file);
    expect_refusal("a.nii", file.header() + voxels, message);
  };
  expect_refusal("a.nii", std::string(352, 'x'), "is no NIfTI-1 file: it does not begin with the number 348");
  expect([](NiftiFile& file) { file.set<std::int32_t>(0, 540); }, "NIfTI-2 is not supported, NIfTI-1 is");
  expect([](NiftiFile& file) { file.set<std::uint8_t>(345, 'i'); },
         "is no NIfTI-1 file of header and voxels in one: it has no \"n+1\" at byte 344");
  expect([](NiftiFile& file) { file.set<std::int16_t>(70, 32); },
         "datatype = 32: not supported, integers and floats are");
  expect([](NiftiFile& file) { file.set<std::int16_t>(40, 4).set<std::int16_t>(48, 2); },
         "dim[4] = 2: one label a voxel is needed");
  expect([](NiftiFile& file) { file.set<float>(112, 2.0F); }, "scl_slope = 2, scl_inter = 0: labels are not scaled");
  expect([](NiftiFile& file) { file.set<float>(80, std::nanf("")); }, "pixdim of its header is nan: must be finite");
  expect([](NiftiFile& file) { file.set<float>(80, -1.0F); }, "pixdim[1] = -1: must be above 0");
  expect([](NiftiFile& file) { file.set<float>(108, 1e9F); },
         "vox_offset = 1000000000: must be after the header and within the file");
  expect([](NiftiFile& file) { file.set<std::int16_t>(42, 30000); },
         "30000 x 1 x 1 voxels of 2 bytes: more than a file of 356 bytes can hold");
  expect([](NiftiFile& file) { file.set<std::uint8_t>(123, 4); }, "xyzt_units: 4 is no unit of length");
}

}  // namespace
}  // namespace verisq
