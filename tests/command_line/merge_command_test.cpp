/// Maps in parts, and `verisq merge`: the bytes of one process, and refusals of what does not belong together.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <random>
#include <string>
#include <vector>
#include <verisq/map_file.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

using ::testing::HasSubstr;

const std::string examples = places::example("");
const std::string stem = examples + "/stem_mm.json";

/// Whole blocks, the beginnings of which have points within overlaps of the stem's primitives, and a part of one.
constexpr std::size_t count = 3 * rows_per_block + 500;

std::string points_text(unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> around(-60.0, 60.0);
  std::uniform_real_distribution<double> near(-9.0, 9.0);
  std::string text = "x,y,z\n";
  for (std::size_t i = 0; i < count; ++i) {
    const bool inside = i % rows_per_block < 7;
    const auto coordinate = [&](double centre) { return std::to_string(centre + (inside ? near : around)(generator)); };
    text += coordinate(123.0) + "," + coordinate(7.0) + "," + coordinate(-158.0) + "\n";
  }
  return text;
}

class MergeCommand : public ProgramTest {
 protected:
  [[nodiscard]] std::string points() const { return write("points.csv", points_text(3)); }

  [[nodiscard]] Outcome map(const std::string& output, const Arguments& more = {}) const {
    Arguments arguments{"map", "--model", stem, "--points", path("points.csv"), "-o", path(output)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  /// Parts NAME.1 ... of points.csv.
  void make_parts(unsigned parts, const std::string& extension, const Arguments& more = {}) const {
    for (unsigned part = 1; part <= parts; ++part) {
      Arguments arguments{"--part", std::to_string(part) + "/" + std::to_string(parts)};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Outcome outcome = map(name_of(part, extension), arguments);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
    }
  }
  [[nodiscard]] static std::string name_of(unsigned part, const std::string& extension) {
    return "part." + std::to_string(part) + extension;
  }

  [[nodiscard]] Outcome merge(const std::vector<std::string>& parts, const std::string& output,
                              const Arguments& more = {}) const {
    Arguments arguments{"merge"};
    for (const std::string& part : parts) arguments.push_back(path(part));
    arguments.insert(arguments.end(), {"-o", path(output)});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

TEST_F(MergeCommand, MakesTheBytesOfOneProcess) {
  (void)points();
  for (const std::string extension : {".csv", ".npy"}) {
    ASSERT_EQ(map("whole" + extension).status, 0);
    make_parts(3, extension);
    const Outcome outcome =
        merge({name_of(3, extension), name_of(1, extension), name_of(2, extension)}, "merged" + extension);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(contents(path("merged" + extension)) == contents(path("whole" + extension))) << extension;
  }
}

TEST_F(MergeCommand, SumsUpWhatThePartsSay) {
  (void)points();
  const Arguments form{"--columns", "index,lo,hi,status", "--json"};
  const Outcome whole = map("whole.npy", form);
  make_parts(2, ".npy", form);
  const Outcome merged = merge({"part.1.npy", "part.2.npy"}, "merged.npy", {"--json"});
  EXPECT_EQ(contents(path("merged.npy")), contents(path("whole.npy")));
  const auto of_whole = nlohmann::json::parse(whole.out);
  const auto of_merged = nlohmann::json::parse(merged.out);
  for (const char* const key :
       {"points", "device_verified", "host_verified", "wide", "largest_width", "smallest_distance"}) {
    EXPECT_EQ(of_merged.at(key), of_whole.at(key)) << key;
  }
  EXPECT_EQ(of_merged.at("parts"), 2);
}

TEST_F(MergeCommand, MergesMapsOfPosesTrianglesAndCertificates) {
  std::string poses;
  for (int i = 0; i < 5000; ++i) poses += std::to_string(60 + i % 37) + ",0," + std::to_string(i % 11) + ",1,0.1,0,0\n";
  const std::string file = write("poses.csv", poses);
  const Arguments distance{"distance", examples + "/capsule.json", examples + "/soap.json", "--poses", file};
  const auto run_distance = [&](const Arguments& more) {
    Arguments arguments = distance;
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments).status, 0);
  };
  run_distance({"-o", path("whole.csv")});
  for (const char* const part : {"1/2", "2/2"}) {
    run_distance({"-o", path("poses." + std::string(part, 1) + ".csv"), "--part", part});
  }
  EXPECT_EQ(merge({"poses.1.csv", "poses.2.csv"}, "merged.csv").status, 0);
  EXPECT_TRUE(contents(path("merged.csv")) == contents(path("whole.csv")));

  const Arguments triangles{"map",       "--model",       stem, "--mesh", examples + "/cavity.off", "--on",
                            "triangles", "--certificates"};
  const auto run_map = [&](const Arguments& more) {
    Arguments arguments = triangles;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments).status;
  };
  ASSERT_EQ(run_map({"-o", path("triangles.csv")}), 0);
  ASSERT_EQ(run_map({"-o", path("triangles.1.csv"), "--part", "1/2"}), 0);
  ASSERT_EQ(run_map({"-o", path("triangles.2.csv"), "--part", "2/2"}), 0);
  EXPECT_EQ(merge({"triangles.1.csv", "triangles.2.csv"}, "all.csv").status, 0);
  EXPECT_TRUE(contents(path("all.csv")) == contents(path("triangles.csv")));
}

TEST_F(MergeCommand, NamesPartsThatAreDrawn) {
  (void)points();
  make_parts(3, ".vtp");
  const std::vector<std::string> parts{"part.1.vtp", "part.2.vtp", "part.3.vtp"};
  expect_refused(merge(parts, "whole.vtp"), {"whole.vtp", "is a .pvtp"});
  const Outcome outcome = merge(parts, "whole.pvtp");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("{}\n", count)));
  EXPECT_THAT(outcome.out, HasSubstr("] of these points, not of what lies between\n"));
  pugi::xml_document whole;
  ASSERT_TRUE(whole.load_file(path("whole.pvtp").c_str()));
  const pugi::xml_node data = whole.child("VTKFile").child("PPolyData");
  std::size_t points_of_pieces = 0;
  std::vector<std::string> sources;
  for (const pugi::xml_node piece : data.children("Piece")) {
    sources.emplace_back(piece.attribute("Source").value());
    // Before the raw arrays the XML of a piece is text.
    const std::string text = contents(path(sources.back()));
    pugi::xml_document part;
    const std::string head = text.substr(0, text.find("  <AppendedData")) + "</VTKFile>";
    ASSERT_TRUE(part.load_string(head.c_str()));
    const pugi::xml_node drawn = part.child("VTKFile").child("PolyData").child("Piece");
    points_of_pieces += drawn.attribute("NumberOfPoints").as_ullong();
    const auto names = [](const pugi::xml_node& node) {
      std::vector<std::string> all;
      for (const pugi::xml_node array : node.children()) all.emplace_back(array.attribute("Name").value());
      return all;
    };
    EXPECT_EQ(names(drawn.child("PointData")), names(data.child("PPointData")));
  }
  EXPECT_EQ(sources, parts);
  EXPECT_EQ(points_of_pieces, count);
  std::ofstream(path("part.2.vtp"), std::ios::app) << " ";
  expect_refused(merge(parts, "whole.pvtp"), {"part.2.vtp", "is not the file that was written"});
}

TEST_F(MergeCommand, HasPartsWithoutRowsWhereThereAreMoreThanBlocks) {
  (void)write("points.csv", "1,2,3\n4,5,6\n");
  ASSERT_EQ(map("whole.csv").status, 0);
  make_parts(3, ".csv");
  EXPECT_EQ(contents(path("part.3.csv")), "index,lo,hi,status\n");
  EXPECT_EQ(merge({"part.1.csv", "part.2.csv", "part.3.csv"}, "merged.csv").status, 0);
  EXPECT_EQ(contents(path("merged.csv")), contents(path("whole.csv")));
}

/// Changes what stands beside a part.
void edit(const std::string& part, const std::function<void(nlohmann::ordered_json&)>& change) {
  const std::string file = part + ".part.json";
  auto json = nlohmann::ordered_json::parse(contents(file));
  change(json);
  std::ofstream(file) << json.dump(2);
}

TEST_F(MergeCommand, RefusesForgedSets) {
  (void)points();
  make_parts(3, ".csv");
  const std::vector<std::string> all{"part.1.csv", "part.2.csv", "part.3.csv"};
  const std::string second = contents(path("part.2.csv"));
  const std::string beside = contents(path("part.2.csv.part.json"));
  const auto restore = [&] {
    (void)write("part.2.csv", second);
    (void)write("part.2.csv.part.json", beside);
  };
  const std::string other_digest(64, 'a');
  struct Forgery {
    std::function<void()> make;
    std::vector<std::string> parts;
    std::vector<std::string> words;
  };
  const auto in_second = [&](const std::function<void(nlohmann::ordered_json&)>& change) {
    return [this, change] { edit(path("part.2.csv"), change); };
  };
  const auto nothing = [] {};
  const std::vector<Forgery> forgeries{
      {nothing, {"part.1.csv", "part.3.csv"}, {"part 2 of 3 is missing"}},
      {nothing, {"part.1.csv", "part.2.csv"}, {"part 3 of 3 is missing"}},
      {nothing, {"part.1.csv", "part.2.csv", "part.2.csv", "part.3.csv"}, {"part.2.csv", "is part 2 of 3, as"}},
      {in_second([&](auto& json) { json["models"][0]["sha256"] = other_digest; }),
       all,
       {"part.2.csv", "the model is", other_digest}},
      {in_second([&](auto& json) { json["input"]["sha256"] = other_digest; }),
       all,
       {"part.2.csv", "the input is", other_digest}},
      {in_second([](auto& json) { json["settings"]["tolerance"] = "0.5"; }),
       all,
       {"part.2.csv", "tolerance is 0.5, but"}},
      {in_second([](auto& json) { json["settings"]["point_radius"] = "1"; }),
       all,
       {"part.2.csv", "point_radius is 1, but 0"}},
      {in_second([](auto& json) { json["settings"]["pose"] = "1,0,0,1,0,0,0"; }),
       all,
       {"part.2.csv", "pose is 1,0,0,1,0,0,0, but nothing"}},
      {in_second([](auto& json) { json["summary"]["device"] = "abacus"; }),
       all,
       {"part.2.csv", "the device is abacus, but"}},
      {in_second([](auto& json) { json["version"] = "0.0.1"; }), all, {"part.2.csv", "the version of verisq is 0.0.1"}},
      {in_second([](auto& json) { json["elements"] = "triangles"; }), all, {"part.2.csv", "what rows are of"}},
      {in_second([](auto& json) { json["rows"]["first"] = 0; }),
       all,
       {"rows.first = 0", "not the rows of part 2 of 3"}},
      {in_second([](auto& json) { json["format"] = "verisq-part/2"; }), all, {"format", "must be \"verisq-part/1\""}},
      {in_second([](auto& json) { json["extra"] = 1; }), all, {"extra", "unknown"}},
      {in_second([](auto& json) { json["summary"]["wide"] = 5; }), all, {"summary.wide = 5", "must add up"}},
      {[&] { std::filesystem::remove(path("part.2.csv.part.json")); },
       all,
       {"part.2.csv.part.json: no such file: ", "part.2.csv is no part of a map, as --part writes them"}},
      {[&] { (void)write("part.2.csv.part.json", "{"); }, all, {"part.2.csv.part.json"}},
      {[&] {  // one digit of one bound
         std::string forged = second;
         forged[forged.size() / 2] = forged[forged.size() / 2] == '3' ? '4' : '3';
         (void)write("part.2.csv", forged);
       },
       all,
       {"part.2.csv", "is not the file that was written"}},
      {[&] { (void)write("part.2.csv", second.substr(0, second.rfind('\n', second.size() - 2) + 1)); },
       all,
       {"part.2.csv", "rows, and should have"}},
      {[&] { (void)write("part.2.csv", "lo,hi\n" + second.substr(second.find('\n') + 1)); },
       all,
       {"part.2.csv", "another header"}},
      {[&] { (void)write("part.2.csv", ""); }, all, {"part.2.csv", "empty"}},
      {nothing, {"part.1.csv", "no.csv"}, {"no.csv.part.json: no such file"}},
  };
  for (const auto& [make, parts, words] : forgeries) {
    make();
    SCOPED_TRACE(::testing::PrintToString(words));
    expect_refused(merge(parts, "merged.csv"), words);
    EXPECT_FALSE(std::filesystem::exists(path("merged.csv")));
    restore();
  }
  expect_refused(merge(all, "part.1.csv"), {"part.1.csv", "is a part itself"});
  EXPECT_EQ(merge(all, "merged.csv").status, 0);
}

TEST_F(MergeCommand, GnuParallelRunsTheExample) {
  if (!std::filesystem::exists("/usr/bin/parallel")) GTEST_SKIP() << "no GNU parallel";
  (void)points();
  ASSERT_EQ(map("whole.npy").status, 0);
  const Outcome outcome = Process({"/usr/bin/env", std::string("VERISQ=") + places::program(),
                                   examples + "/cluster/map_in_parallel", stem, path("points.csv"), path("all"), "3"},
                                  folder_.path())
                              .wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contents(path("all.npy")) == contents(path("whole.npy")));
}

TEST_F(MergeCommand, AcceptsSeveralDevicesWhereAskedTo) {
  (void)points();
  make_parts(2, ".csv", {"--device", "host"});
  edit(path("part.2.csv"), [](auto& json) { json["summary"]["device"] = "another host"; });
  expect_refused(merge({"part.1.csv", "part.2.csv"}, "merged.csv"), {"the device is another host, but host in"});
  const Outcome outcome = merge({"part.1.csv", "part.2.csv"}, "merged.csv", {"--mixed-devices"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("device             \"host, another host\"\n"));
}

TEST_F(MergeCommand, PartsAreRefusedWhereRowsWouldDependOnMoreThanTheirBlock) {
  (void)points();
  const auto part = [&](const Arguments& more, const std::string& output = "part.csv") {
    Arguments arguments{"--part", "1/2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return map(output, arguments);
  };
  expect_refused(part({"--time-limit", "5"}), {"--part", "--time-limit"});
  expect_refused(part({"--translation-error", "1", "--pose-divisions", "4"}), {"--part", "--pose-divisions"});
  expect_refused(part({}, "part.ply"), {"--part", ".csv and .npy only"});
  expect_refused(part({"--certificates"}, "part.vtp"), {"--part", "certificates", ".csv only"});
  expect_refused(map("part.csv", {"--part", "3/2"}), {"--part", "3"});
  expect_refused(map("part.csv", {"--part", "0/2"}), {"--part", "0"});
  expect_refused(map("part.csv", {"--part", "two"}), {"--part", "two", "i/n"});
  expect_refused(run({"map", "--model", stem, "--points", "-", "-o", path("p.csv"), "--part", "1/2"}),
                 {"--part", "--points"});
  expect_refused(run({"distance", stem, stem, "--part", "1/2"}), {"--part", "--poses"});
}

TEST(RowsOfPart, AreWholeBlocksOneBehindTheOther) {
  for (const std::uint64_t rows : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{2048}, std::uint64_t{2049},
                                   std::uint64_t{100'000}, std::uint64_t{1'000'000'007}}) {
    for (const std::uint64_t parts : {1U, 2U, 3U, 7U, 1000U}) {
      std::uint64_t next = 0;
      for (std::uint64_t part = 1; part <= parts; ++part) {
        const RowRange range = rows_of_part(part, parts, rows);
        EXPECT_EQ(range.first, next);
        EXPECT_TRUE(range.first % rows_per_block == 0 || range.count == 0);
        next += range.count;
      }
      EXPECT_EQ(next, rows);
    }
  }
}

}  // namespace
}  // namespace verisq::testing
