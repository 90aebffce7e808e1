/// The unedited test vectors of ITF1788 for IEEE 1788-2015 (tests/itf1788): what the host's intervals and the kernels'
/// make of each, counted by operation and compared with the tables of docs/accuracy.md.
///
/// VERISQ_UPDATE_ACCURACY=1 writes the tables into docs/accuracy.md anew.
#include "tests/arithmetic/interval_vectors.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/device.hpp>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verify/numbers/functions.hpp"
#include "verify/stance/bounce.hpp"
#include "verify/stance/scalar.hpp"

namespace verisq {
namespace {

using device::Ends;
using testing::IntervalVector;
using testing::Literal;
using verify::BasicInterval;
using verify::Direction;
using verify::Interval;
using verify::PreciseInterval;
using verify::Real;

// ---------------------------------------------------------------- the vectors

const std::vector<IntervalVector>& vectors() {
  static const std::vector<IntervalVector> all = [] {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(VERISQ_INTERVAL_VECTORS)) {
      if (entry.path().extension() == ".itl") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    std::vector<IntervalVector> result;
    for (const auto& file : files) std::ranges::move(testing::read_interval_vectors(file), std::back_inserter(result));
    return result;
  }();
  return all;
}

Ends ends(const Literal& a) {
  return {a.lower, a.upper};
}

/// The interval that a vector demands, or the number as a point. Decorations are left aside.
Ends expected(const IntervalVector& vector) {
  return ends(vector.results.front());
}

std::string text(Ends a) {
  return device::is_empty(a) ? "empty" : fmt::format("[{:a}, {:a}]", a.lo, a.hi);
}

// ---------------------------------------------------------------- counting

enum class Verdict { exact, containing, violated, refused, unsupported };

/// `reason` for what is unsupported.
struct Judgement {
  Verdict verdict;
  std::string reason;
};

/// Zeros of either sign are the same number; everything contains the empty set.
Judgement judge(Ends demanded, Ends result) {
  const bool both_empty = device::is_empty(demanded) && device::is_empty(result);
  if (both_empty || (demanded.lo == result.lo && demanded.hi == result.hi)) return {Verdict::exact, {}};
  const bool contains = device::is_empty(demanded) || (result.lo <= demanded.lo && demanded.hi <= result.hi);
  return {contains ? Verdict::containing : Verdict::violated, {}};
}

constexpr const char* no_such_operation = "no such operation";

class Counts {
 public:
  void add(const IntervalVector& vector, const Judgement& judgement) {
    Row& row = rows_[vector.operation];
    ++row[static_cast<std::size_t>(judgement.verdict)];
    if (judgement.verdict == Verdict::refused && !device::is_empty(expected(vector))) ++withheld_[vector.operation];
    if (judgement.verdict != Verdict::unsupported) return;
    ++(judgement.reason == no_such_operation ? missing_[vector.operation] : reasons_[judgement.reason]);
  }

  /// In Markdown: the operations that there are, why vectors are unsupported, and the operations that there are not.
  [[nodiscard]] std::string table() const {
    std::string result =
        "| operation        | vectors |   exact | containing | violated | refused | unsupported |\n"
        "| ---------------- | ------: | ------: | ---------: | -------: | ------: | ----------: |\n";
    Row all{};
    for (const auto& [operation, row] : rows_) {
      for (std::size_t i = 0; i < row.size(); ++i) all[i] += row[i];
      if (!missing_.contains(operation)) result += line(operation, row);
    }
    result += line("all operations", all);
    if (!withheld_.empty()) result += paragraph("Refused, though the standard has a result", withheld_);
    if (!reasons_.empty()) result += paragraph("Unsupported operands", reasons_);
    return result + paragraph("Unsupported operations", missing_);
  }

 private:
  using Row = std::array<std::size_t, 5>;

  [[nodiscard]] static std::string line(const std::string& name, const Row& row) {
    const std::size_t sum = row[0] + row[1] + row[2] + row[3] + row[4];
    return fmt::format("| {:16} | {:7} | {:7} | {:10} | {:8} | {:7} | {:11} |\n", name, sum, row[0], row[1], row[2],
                       row[3], row[4]);
  }

  /// After an empty line, in lines of at most 120 columns.
  [[nodiscard]] static std::string paragraph(const char* title, const std::map<std::string, std::size_t>& counts) {
    std::string result;
    std::string line = fmt::format("\n{}:", title);
    const char* end = "";
    for (const auto& [name, count] : counts) {
      line += end;
      const std::string item = fmt::format(" {} {}", name, count);
      if (line.size() + item.size() < 120) {
        line += item;
      } else {
        result += fmt::format("{}\n", line);
        line = item.substr(1);
      }
      end = ",";
    }
    return fmt::format("{}{}.\n", result, line);
  }

  std::map<std::string, Row> rows_;
  std::map<std::string, std::size_t> withheld_;  // refused with a result in the standard, by operation
  std::map<std::string, std::size_t> reasons_;   // of what is unsupported, but for
  std::map<std::string, std::size_t> missing_;   // operations that there are not
};

// ---------------------------------------------------------------- the document

const std::filesystem::path document = VERISQ_ACCURACY_DOCUMENT;

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Between two comments that name the arithmetic.
struct Section {
  std::string before, table, after;
};

Section section(const std::string& name) {
  const std::string whole = content(document);
  const std::string opening = fmt::format("<!-- vectors: {} -->\n\n", name);
  const std::string closing = fmt::format("\n<!-- end of vectors: {} -->", name);
  const std::size_t begin = whole.find(opening);
  const std::size_t end = whole.find(closing);
  if (begin == std::string::npos || end == std::string::npos)
    throw std::runtime_error(fmt::format("{}: no {}", document.string(), opening));
  const std::size_t table = begin + opening.size();
  return {whole.substr(0, table), whole.substr(table, end - table), whole.substr(end)};
}

void expect_documented(const std::string& name, const Counts& counts) {
  const Section documented = section(name);
  if (std::getenv("VERISQ_UPDATE_ACCURACY") != nullptr) {
    std::ofstream(document) << documented.before << counts.table() << documented.after;
    return;
  }
  EXPECT_EQ(documented.table, counts.table()) << "docs/accuracy.md: VERISQ_UPDATE_ACCURACY=1 writes it anew";
}

// ---------------------------------------------------------------- the host

template <class T>
using Operands = std::span<const BasicInterval<T>>;

template <class T>
using Operation = std::function<BasicInterval<T>(Operands<T>)>;

/// By the names of the vectors. A result that is a number is a point.
template <class T>
std::map<std::string, Operation<T>> common_operations() {
  using X = BasicInterval<T>;
  using Xs = Operands<T>;
  return {
      {"neg", [](Xs a) { return -a[0]; }},
      {"add", [](Xs a) { return a[0] + a[1]; }},
      {"sub", [](Xs a) { return a[0] - a[1]; }},
      {"mul", [](Xs a) { return a[0] * a[1]; }},
      {"div", [](Xs a) { return a[0] / a[1]; }},
      {"recip", [](Xs a) { return X(1) / a[0]; }},
      {"sqr", [](Xs a) { return square(a[0]); }},
      {"sqrt", [](Xs a) { return sqrt(a[0]); }},
      {"abs", [](Xs a) { return abs(a[0]); }},
      {"exp", [](Xs a) { return exp(a[0]); }},
      {"log", [](Xs a) { return log(a[0]); }},
      {"pow", [](Xs a) { return pow(a[0], a[1]); }},
      {"pown", [](Xs a) { return pow(a[0], a[1]); }},
      {"sin", [](Xs a) { return sin(a[0]); }},
      {"cos", [](Xs a) { return cos(a[0]); }},
      {"atan", [](Xs a) { return atan(a[0]); }},
      {"atan2", [](Xs a) { return polar_angle(a[1], a[0]); }},
      {"convexHull", [](Xs a) { return hull(a[0], a[1]); }},
      {"b-numsToInterval", [](Xs a) { return X(a[0].lower(), a[1].upper()); }},
      {"d-numsToInterval", [](Xs a) { return X(a[0].lower(), a[1].upper()); }},
      {"inf", [](Xs a) { return X(a[0].lower()); }},
      {"sup", [](Xs a) { return X(a[0].upper()); }},
      {"mig", [](Xs a) { return X(abs(a[0]).lower()); }},
      {"mag", [](Xs a) { return X(abs(a[0]).upper()); }},
  };
}

template <class T>
std::map<std::string, Operation<T>> operations();

template <>
std::map<std::string, Operation<Real>> operations() {
  return common_operations<Real>();
}

/// With those of verify/stance.
template <>
std::map<std::string, Operation<double>> operations() {
  auto result = common_operations<double>();
  result.insert({"min", [](Operands<double> a) { return stance::min(a[0], a[1]); }});
  result.insert({"max", [](Operands<double> a) { return stance::max(a[0], a[1]); }});
  result.insert({"sign", [](Operands<double> a) { return stance::sgn(a[0]); }});
  result.insert(
      {"intersection", [](Operands<double> a) { return stance::integration_details::intersection(a[0], a[1]); }});
  return result;
}

Ends rounded_outwards(const Interval& a) {
  return {a.lower(), a.upper()};
}

Ends rounded_outwards(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

/// The host refuses with std::domain_error.
template <class T>
Judgement on_host(const std::map<std::string, Operation<T>>& operations, const IntervalVector& vector) {
  const auto operation = operations.find(vector.operation);
  if (operation == operations.end()) return {Verdict::unsupported, no_such_operation};
  for (const Literal& operand : vector.operands) {
    if (operand.kind == Literal::Kind::not_an_interval) return {Verdict::unsupported, "NaI"};
    if (operand.is_empty()) return {Verdict::unsupported, "the empty interval"};
  }
  try {
    std::vector<BasicInterval<T>> operands;
    for (const Literal& a : vector.operands) operands.emplace_back(T(a.lower), T(a.upper));
    const Ends result = rounded_outwards(operation->second(operands));
    const Judgement judgement = judge(expected(vector), result);
    EXPECT_NE(judgement.verdict, Verdict::violated)
        << vector.place << ": " << text(expected(vector)) << " expected, " << text(result) << " found";
    return judgement;
  } catch (const std::domain_error&) {
    return {Verdict::refused, {}};
  }
}

template <class T>
Counts counts_on_host() {
  const auto available = operations<T>();
  Counts counts;
  for (const IntervalVector& vector : vectors()) counts.add(vector, on_host(available, vector));
  return counts;
}

TEST(IntervalVectors, Binary64OnTheHostIsAsDocumented) {
  expect_documented("host, binary64", counts_on_host<double>());
}

TEST(IntervalVectors, PrecisionOf127BitsOnTheHostIsAsDocumented) {
  expect_documented("host, 127 bits", counts_on_host<Real>());
}

// ---------------------------------------------------------------- the kernels

/// The kernels' operation for one of the vectors', or nothing. 1/x is a division.
std::optional<unsigned> kernel_operation(const std::string& name) {
  static const std::map<std::string, std::string> names{
      {"neg", "neg"}, {"add", "add"},   {"sub", "sub"},         {"mul", "mul"},
      {"div", "div"}, {"recip", "div"}, {"sqr", "square"},      {"sqrt", "sqrt"},
      {"abs", "abs"}, {"exp", "exp"},   {"log", "log"},         {"pow", "pow"},
      {"min", "min"}, {"max", "max"},   {"convexHull", "hull"}, {"intersection", "intersection"}};
  const auto found = names.find(name);
  if (found == names.end()) return std::nullopt;
  const auto all = device::interval_operations();
  for (unsigned i = 0; i < all.size(); ++i) {
    if (all[i].name == fmt::format("interval_{}", found->second)) return i;
  }
  throw std::logic_error(found->second);
}

device::IntervalOperands kernel_operands(const IntervalVector& vector) {
  if (vector.operation == "recip") return {{1.0, 1.0}, ends(vector.operands[0])};
  return {ends(vector.operands[0]), ends(vector.operands.back())};
}

bool has_nai(const IntervalVector& vector) {
  return std::ranges::any_of(vector.operands,
                             [](const Literal& a) { return a.kind == Literal::Kind::not_an_interval; });
}

/// The exact ranges, with which interval_standard_test.cpp and the accuracy report compare random operands.
TEST(IntervalVectors, TheReferenceGivesThem) {
  std::size_t compared = 0;
  for (const IntervalVector& vector : vectors()) {
    const auto index = kernel_operation(vector.operation);
    if (!index || has_nai(vector)) continue;
    const Ends range = device::range_of(device::interval_operations()[*index], kernel_operands(vector));
    EXPECT_EQ(judge(expected(vector), range).verdict, Verdict::exact)
        << vector.place << ": " << text(expected(vector)) << " expected, " << text(range) << " found";
    ++compared;
  }
  EXPECT_GT(compared, 2000U);
}

/// The vectors of one operation at once, as the entry point wants them.
Counts counts_on_device(device::OperationKernels& kernels) {
  Counts counts;
  std::map<unsigned, std::vector<const IntervalVector*>> supported;
  for (const IntervalVector& vector : vectors()) {
    const auto operation = kernel_operation(vector.operation);
    if (!operation) {
      counts.add(vector, {Verdict::unsupported, no_such_operation});
    } else if (has_nai(vector)) {
      counts.add(vector, {Verdict::unsupported, "NaI"});
    } else {
      supported[*operation].push_back(&vector);
    }
  }
  for (const auto& [index, group] : supported) {
    std::vector<device::IntervalOperands> operands;
    for (const IntervalVector* vector : group) operands.push_back(kernel_operands(*vector));
    const std::vector<Ends> results = kernels.apply_to_intervals(index, operands);
    for (std::size_t i = 0; i < group.size(); ++i) {
      const Ends demanded = expected(*group[i]);
      EXPECT_EQ(device::fault(device::interval_operations()[index], operands[i], demanded, results[i]), "")
          << group[i]->place << ": " << text(demanded) << " expected, " << text(results[i]) << " found";
      counts.add(*group[i], judge(demanded, results[i]));
    }
  }
  return counts;
}

TEST(IntervalVectors, KernelsAreAsDocumentedOnEveryDeviceAtEveryWidth) {
  std::size_t tested = 0;
  for (const DeviceReport& report : test_devices()) {
    if (!report.passed) continue;
    const device::Device device = *device::select_device(std::to_string(report.index)).device;
    for (const int width : {16, 8, 4, 1}) {
      SCOPED_TRACE(fmt::format("{}, width {}", device.name, width));
      const cl::Program program =
          device::build_program(device.context, device.device, width, device::self_test_sources());
      device::OperationKernels kernels(device.context, device.device, program, width);
      expect_documented("device", counts_on_device(kernels));
      ++tested;
    }
  }
  if (tested == 0) GTEST_SKIP() << "NO OPENCL DEVICE: the kernels' intervals were NOT tested";
}

// ---------------------------------------------------------------- the reader

TEST(IntervalVectors, AllOfEveryFileAreRead) {
  std::map<std::string, std::size_t> counts;
  for (const IntervalVector& vector : vectors()) ++counts[vector.place.substr(0, vector.place.find(':'))];
  // The files have one vector a line, and neither = nor ; in the comments at the ends of lines.
  std::map<std::string, std::size_t> lines;
  for (const auto& entry : std::filesystem::directory_iterator(VERISQ_INTERVAL_VECTORS)) {
    if (entry.path().extension() != ".itl") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      line.erase(0, line.find_first_not_of(" \t"));
      if (!line.starts_with("//") && line.find(';') != std::string::npos && line.find('=') != std::string::npos)
        ++lines[entry.path().filename().string()];
    }
  }
  EXPECT_EQ(counts, lines);
  EXPECT_EQ(counts.size(), 11U);
}

TEST(IntervalVectors, WhatIsNoVectorIsRefusedWithItsLine) {
  const testing::TemporaryFolder folder;
  const auto error = [&](const std::string& text) -> std::string {
    try {
      (void)testing::read_interval_vectors(folder.file("x.itl", text));
    } catch (const std::runtime_error& refusal) {
      return refusal.what();
    }
    return "";
  };
  EXPECT_EQ(error("testcase a { // one\n  add [1,2]_com [0x1P0,-INFINITY] = [entire]; }"),
            "x.itl:2: not an interval: [0x1P0,-INFINITY]");
  EXPECT_EQ(error("/* a */ testcase a {\nneg [1,2] = [-2,-1] signal X;\nneg [1,2] }"), "x.itl:3: an unfinished vector");
  EXPECT_EQ(error("testcase a {\n neg [1,2 = 3; }"), "x.itl:2: ] is missing");
  EXPECT_EQ(error("neg [1,2] = [-2,-1];"), "x.itl:1: \"testcase\" expected, found \"neg\"");
  EXPECT_EQ(error("testcase a { sum {1, 2} = 3; }\ntestcase b {}"), "");
}

}  // namespace
}  // namespace verisq
