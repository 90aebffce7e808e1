/// Streams points from CSV.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <verisq/point_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // some spreadsheets put it before the header

/// The three fields of a line, without the blanks around them.
std::array<std::string_view, 3> fields(const InputFile& file, std::string_view line) {
  const std::size_t first = line.find(',');
  const std::size_t second = first == std::string_view::npos ? first : line.find(',', first + 1);
  if (second == std::string_view::npos || line.find(',', second + 1) != std::string_view::npos) {
    file.fail(fmt::format("{}: expected three numbers x,y,z", in_quotes(trimmed(line))));
  }
  return {trimmed(line.substr(0, first)), trimmed(line.substr(first + 1, second - first - 1)),
          trimmed(line.substr(second + 1))};
}

bool is_header(std::string_view line) {
  std::string text = lower_case(line);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '"'; });
  return text == "x,y,z";
}

}  // namespace

struct PointFile::State {
  InputFile file;
  bool at_first_line = true;
  bool any_point = false;

  std::optional<std::string_view> next_line();
  std::optional<Point> next_point();
};

/// Without the byte order mark and the header. Blank lines are fine at the end of the file only.
std::optional<std::string_view> PointFile::State::next_line() {
  std::optional<std::string_view> line = file.next_line();
  if (at_first_line && line) {
    at_first_line = false;
    if (line->starts_with(byte_order_mark)) line->remove_prefix(byte_order_mark.size());
    if (is_header(*line)) line = file.next_line();
  }
  if (line && trimmed(*line).empty()) {
    if (file.next_line_with_text()) file.fail("a point after a blank line: blank lines are fine at the end only");
    return std::nullopt;
  }
  return line;
}

std::optional<Point> PointFile::State::next_point() {
  const std::optional<std::string_view> line = next_line();
  if (!line) {
    if (!any_point) file.fail_whole("no points");
    return std::nullopt;
  }
  const auto [x, y, z] = fields(file, *line);
  any_point = true;
  return Point{finite_number(file, x, "x"), finite_number(file, y, "y"), finite_number(file, z, "z")};
}

PointFile::PointFile(const std::filesystem::path& path) : state_(new State{InputFile(path)}) {}
PointFile::~PointFile() = default;
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile& PointFile::operator=(PointFile&&) noexcept = default;

std::size_t PointFile::read(std::span<Point> points) {
  std::size_t count = 0;
  while (count < points.size()) {
    const std::optional<Point> point = state_->next_point();
    if (!point) break;
    points[count++] = *point;
  }
  return count;
}

std::uint64_t PointFile::bytes_read() const {
  return state_->file.position();
}
std::uint64_t PointFile::bytes_total() const {
  return state_->file.size();
}

}  // namespace verisq
