/// Formats the medians of the rows of Table 6.
#include "bench/table6_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "bench/paper_tables.hpp"
#include "bench/row_counters.hpp"

namespace verisq::bench {
namespace {

struct Tool {
  std::string row;
  std::string label;
};

std::vector<Tool> all_tools(std::span<const std::string> devices) {
  std::vector<Tool> tools{{"verisq_published", "verisq, the paper's method"}, {"verisq_host", "verisq, host"}};
  for (const std::string& device : devices) tools.push_back({device, device + ", kernels"});
  tools.push_back({"fcl_libccd", "FCL/libccd GJK"});
  tools.push_back({"ipopt", "IPOPT"});
  return tools;
}

/// A dash where there is no such figure.
std::string cell(double figure, int precision = 3) {
  return std::isnan(figure) ? fmt::format("{:>12}", "-") : fmt::format("{:>12.{}g}", figure, precision);
}

/// The figures of one tool on one object, unverified and verified.
class Figures {
 public:
  Figures(const Rows& rows, std::string_view tool, std::string_view kind, std::string_view object)
      : rows_(&rows),
        unverified_(row_name(tool, kind, object)),
        verified_(row_name(tool, fmt::format("{}_verified", kind), object)) {}

  [[nodiscard]] double unverified(const char* name) const { return counter(*rows_, unverified_, name); }
  [[nodiscard]] double verified(const char* name) const { return counter(*rows_, verified_, name); }
  [[nodiscard]] double seconds() const { return 1.0 / unverified("queries_per_second"); }
  [[nodiscard]] double verified_seconds() const { return 1.0 / verified("queries_per_second"); }
  [[nodiscard]] double either(const char* name) const {
    return std::isnan(verified(name)) ? unverified(name) : verified(name);
  }

 private:
  const Rows* rows_;
  std::string unverified_;
  std::string verified_;
};

std::string heading() {
  return fmt::format("{:<28}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "queries", "time, s",
                     "verified, s", "width", "relative", "failures", "above hi, %", "largest");
}

std::string paper_line(std::string_view method, const PaperDistance& paper) {
  return fmt::format("  {:<26}{:>12}{}{}{}{}\n", fmt::format("the paper, {}", method), "1e+05", cell(paper.seconds),
                     cell(paper.verified_seconds), cell(paper.absolute_error), cell(paper.relative_error));
}

std::string tool_line(const Tool& tool, const Figures& figures) {
  return fmt::format("  {:<26}{}{}{}{}{}{}{}{}\n", tool.label, cell(figures.either("queries")), cell(figures.seconds()),
                     cell(figures.verified_seconds()), cell(figures.verified("width_mean")),
                     cell(figures.verified("relative_width_mean")), cell(figures.either("failures")),
                     cell(100.0 * figures.unverified("errs_upwards")),
                     cell(figures.unverified("largest_error_upwards")));
}

template <class Object>
std::string section(const Rows& rows, const std::vector<Tool>& tools, std::string_view kind, const Object& object) {
  std::string text = fmt::format("{}: {}\n", kind, object.name);
  text += paper_line("GJK", object.paper);
  text += paper_line("IPOPT", object.paper_ipopt);
  for (const Tool& tool : tools) text += tool_line(tool, Figures(rows, tool.row, kind, object.name));
  return text;
}

/// How many times as long as a device's verified answer a peer takes for its unverified one.
template <class Objects>
std::string ratios(const Rows& rows, const std::string& device, std::string_view kind, const Objects& objects) {
  std::string text;
  for (const Tool& peer : {Tool{"fcl_libccd", "FCL/libccd GJK"}, Tool{"ipopt", "IPOPT"}}) {
    text += fmt::format("{} unverified / {} verified, time a {}:", peer.label, device, kind);
    for (const auto& object : objects) {
      const double ratio = Figures(rows, peer.row, kind, object.name).seconds() /
                           Figures(rows, device, kind, object.name).verified_seconds();
      text += std::isnan(ratio) ? fmt::format("  {} -", object.name) : fmt::format("  {} {:.4g} x", object.name, ratio);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string table6(const Rows& rows, std::span<const std::string> devices) {
  const std::vector<Tool> tools = all_tools(devices);
  std::string text =
      "Table 6, reproduced and extended: seconds a query; width and width / midpoint of the enclosures, means;\n"
      "share of unverified answers above our enclosures, and the largest error upwards\n" +
      heading();
  for (const BenchmarkObject& object : table5_objects) text += section(rows, tools, "point", object);
  for (const BenchmarkPair& pair : table6_pairs) text += section(rows, tools, "pair", pair);
  for (const std::string& device : devices)
    text += ratios(rows, device, "point", table5_objects) + ratios(rows, device, "pair", table6_pairs);
  return text;
}

}  // namespace verisq::bench
