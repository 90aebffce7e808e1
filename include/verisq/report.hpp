/// A finished map for people to look at: a page that opens by itself in a browser, and a still picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// One line of the certified summary, as the program prints it.
struct ReportLine {
  std::string label;
  std::string value;
};

/// Lets a page prove its rows again in the reader's browser: pages hold the model file's text, the vertices and the
/// certificates, bit for bit. Spans must outlive the call.
struct ReportProof {
  std::span<const Certificate> certificates;  ///< one a row
  std::filesystem::path model_file;           ///< as `implant` was read; a regular file
  std::filesystem::path mesh_file;            ///< as `bone` was read; a regular file, of which the page has the SHA-256
  bool moved = false;                         ///< the primitives stand where `implant` says, not where the file does
  double point_radius = 0.0;                  ///< as that of `MapOptions`
};

/// The contents of a report. Spans and references must outlive the call.
struct Report {
  std::string title;
  const Mesh& bone;                        ///< rows are of its vertices
  std::span<const MapResult> rows;         ///< one a vertex
  const Model& implant;                    ///< drawn transparent
  std::string units;                       ///< of lengths; may be empty
  std::vector<ReportLine> summary;         ///< table, in this order
  std::vector<std::string> area_names;     ///< empty: no areas
  std::span<const std::uint32_t> area_of;  ///< one a vertex where there are areas
  std::string solid_name = "implant";      ///< what `implant` is called
  std::span<const Pose> path = {};         ///< by which the implant came: rows are of all of it, the page has a slider
  std::optional<double> range = {};        ///< colours end at this distance, > 0; default as `default_range` says
  std::optional<Point> up = {};            ///< what pictures have on top, not zero; default: the bone's long axis, at
                                           ///< the end that is the implant's
  std::optional<ReportProof> proof = {};   ///< of maps with certificates
};

/// Where colours end unless a report says it: at 3 mm, between which implants are judged, where `units` are mm, cm or m
/// and at least a tenth of the lower bounds is nearer; else round, and so that few are beyond.
[[nodiscard]] double default_range(std::span<const MapResult> rows, std::string_view units);

/// A self-contained `.html` (no network): the bone coloured by its proven distances, the implant, [lo, hi] where the
/// pointer is, histogram, summary. Distances are kept as exact binary64; with `proof` the page proves them again.
/// Throws Error(failure) when the file cannot be written, Error(input) when one that `proof` names cannot be read.
void write_html_report(const std::filesystem::path& path, const Report& report);

/// A still picture `.png` of the bone coloured by the proven lower bound, the implant showing through, and the colour
/// scale. Precondition: width, height in [64, 16384] pixels. Throws as above.
void write_picture(const std::filesystem::path& path, const Report& report, int width = 1600, int height = 1000);

}  // namespace verisq
