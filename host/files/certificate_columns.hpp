/// Certificates stored by column: the arrays in which a `.vtp` holds them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/map_file.hpp>

namespace verisq {

/// A row for each certificate. The mesh formats know only arrays of one tuple a point or cell, so the first normal is a
/// column of its own (to be drawn as glyphs) and all others of all rows follow each other in a separate table.
struct CertificateColumns {
  static constexpr std::int32_t no_primitive = -1;
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  static constexpr Point no_escape{none, none, none};
  static constexpr std::array<double, 2> no_weights{none, none};

  MapElements elements = MapElements::vertices;
  std::vector<std::int32_t> primitive;  ///< of the first normal, or no_primitive: then there are no normals at all
  std::vector<Point> normal;            ///< zero where there is none: a glyph of no length
  std::vector<Point> escape;            ///< of vertices; empty for triangles
  std::vector<std::array<double, 2>> weights;     ///< of triangles; empty for vertices
  std::vector<std::int64_t> further_normals_end;  ///< after the last of the row's in the table below

  std::vector<std::int32_t> further_primitive;
  std::vector<Point> further_normal;

  bool covered = false;                 ///< whether there are those below
  std::vector<Point> witness;           ///< or no_escape
  std::vector<std::int64_t> cover_end;  ///< after the last of the row's in the table below
  std::vector<std::uint8_t> cover;      ///< 1 or 0

  /// Precondition: indices of primitives below 2^31 (those of any model in memory are), the escape and the
  /// weights not NaN.
  void append(const Certificate& certificate);

  struct Range {
    std::size_t begin;
    std::size_t end;
  };
  /// Where the further normals of row `row` are. Precondition: the ends ascend from 0 or more.
  [[nodiscard]] Range further_normals(std::size_t row) const;

  /// Overwrites `certificate` with row `row`. Precondition: the columns are as `append` leaves them.
  void read(std::size_t row, Certificate& certificate) const;
};

}  // namespace verisq
