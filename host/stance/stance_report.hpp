/// Tables 2, 3 and 4 of the paper beside what this program encloses, cell by cell (audit: docs/stance.md §1).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/stance_analysis.hpp>

namespace verisq::stance {

enum class CellVerdict : std::uint8_t {
  match,      ///< each end within 0.01 of the printed one, after directed rounding to the second digit
  misprint,   ///< each end within 0.01 of what the audit says the paper should have printed; `reason` says why
  differs,    ///< neither
  unprinted,  ///< our copy of the paper has no number there
};

[[nodiscard]] std::string_view word(CellVerdict verdict);

/// Ends in hundredths of the unit: whole numbers, or infinite.
struct Hundredths {
  double lo;
  double hi;

  [[nodiscard]] bool operator==(const Hundredths&) const = default;
};

/// The tightest hundredths around an enclosure: lower end down, upper end up.
[[nodiscard]] Hundredths rounded_outward(const Enclosure& enclosure);

/// "[-50.17, 45.49]", or one number where the ends are equal.
[[nodiscard]] std::string text(const Hundredths& cell);

struct Cell {
  std::string_view row;     ///< w1, w2, w4, w6
  std::string_view column;  ///< as in the paper
  Hundredths ours;
  std::string printed;  ///< empty where unprinted
  CellVerdict verdict;
  std::string_view reason;  ///< of a misprint, else empty
  /// Constants of examples/stance.xml that enter the cell and were chosen so that the tables come out: that it matches
  /// is no evidence for them.
  std::vector<std::string_view> reconstructed;
};

/// All that a cell may name.
[[nodiscard]] std::vector<std::string_view> reconstructed_constants();

struct PaperTable {
  std::string_view title;
  std::vector<Cell> cells;
};

struct PaperReport {
  std::array<PaperTable, 3> tables;          ///< 2, 3, 4
  ReferenceUncertainty unrounded;            ///< of Table 4, from sensitivities that are not rounded first
  [[nodiscard]] bool all_explained() const;  ///< no cell differs
};

/// In paper mode, of a model that has the parameters mp, px, Fx and mf. Throws Error(input) that names a missing one.
[[nodiscard]] PaperReport compare_with_paper(const Model& model);

}  // namespace verisq::stance
