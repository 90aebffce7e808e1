/// The landmark format `verisq-landmarks/1`: what docs/formats.md accepts and refuses.
#include <fmt/format.h>

#include <verisq/landmark_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "host/files/landmark_points.hpp"
#include "host/files/output_file.hpp"

namespace verisq {
namespace {

constexpr std::string_view format_name = "verisq-landmarks/1";

}  // namespace

LandmarkFile parse_landmarks(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (!document.is_object()) root.fail("must be an object");
  root.check_keys({"format", "units", "side", "head_radius", "landmarks"});
  if (const JsonValue format = root.at("format"); format.text() != format_name)
    format.fail(fmt::format("must be \"{}\"", format_name));
  if (const auto units = root.find("units"); units && units->text() != "mm") units->fail("must be \"mm\"");
  LandmarkFile file{.landmarks = read_landmark_points(root.at("landmarks")), .side = read_side(root)};
  if (const auto radius = root.find("head_radius")) {
    file.landmarks.head_radius = radius->number();
    if (!(*file.landmarks.head_radius > 0.0)) radius->fail("must be positive");
  }
  return file;
}

LandmarkFile read_landmarks(const std::filesystem::path& path) {
  constexpr std::size_t largest = std::size_t{1} << 20;
  InputFile file(path);
  const std::string_view text = file.peek(largest + 1);
  if (text.size() > largest) file.fail_whole(fmt::format("larger than {} bytes: no landmarks", largest));
  return parse_landmarks(text, path.string());
}

void write_landmarks(const std::filesystem::path& path, const LandmarkFile& file) {
  nlohmann::ordered_json document{{"format", format_name}, {"units", "mm"}};
  if (file.side) document["side"] = *file.side == Side::left ? "left" : "right";
  if (file.landmarks.head_radius) document["head_radius"] = *file.landmarks.head_radius;
  document["landmarks"] = nlohmann::ordered_json::object();
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = file.landmarks.*point) document["landmarks"][name] = *at;
  }
  OutputFile out(path);
  out.write(document.dump(2) + "\n");
  out.finish();
}

}  // namespace verisq
