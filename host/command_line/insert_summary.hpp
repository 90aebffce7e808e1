/// What `verisq insert` says about the whole bone: for people, or as one JSON object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/insertion.hpp>
#include <verisq/least_removal.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/removed_volume.hpp>
#include <verisq/report.hpp>

namespace verisq::command_line {

struct InsertReport {
  MapSummary summary = {};
  std::uint64_t proven_cut = 0;        ///< points with hi < 0: the implant passes through them
  std::uint64_t proven_untouched = 0;  ///< points with lo >= 0: no point of its inside ever reaches them
  std::uint64_t undecided = 0;
  Enclosure deepest_penetration{0.0, 0.0};  ///< of all points; [0, 0] where all are untouched
  std::size_t poses = 0;
  std::string output = {};  ///< the file that holds the map; empty when none was kept
  std::string units = {};   ///< of the implant; empty when not given
  double tolerance = 0.0;
  double seconds = 0.0;                       ///< wall time of all
  std::optional<MeshClearance> surface = {};  ///< of whole triangles along the path, where asked for
  double surface_seconds = 0.0;
  std::optional<RemovedVolume> removed = {};        ///< where asked for
  double volume_tolerance = 0.0;                    ///< of the volume's lower end
  double least_volume_tolerance = 0.0;              ///< in cubic units: so wide it may be, however small the volume is
  double volume_seconds = 0.0;                      ///< wall time of the volume
  std::optional<WayIn> way = {};                    ///< of paths that are not given pose by pose
  std::optional<LeastRemoval> search = {};          ///< of that way among others, where asked for
  std::string certificate = {};                     ///< the certificates' file; empty when not written
  bool certified_points = false;                    ///< they are of the rows
  std::uint64_t looser_certificates = 0;            ///< rows of which they prove less than the map says
  std::optional<Enclosure> certified_surface = {};  ///< what they prove of the whole surface
  std::optional<Enclosure> certified_volume = {};   ///< what they prove of the removed volume
  std::string page = {};                            ///< the report's file; empty when not written
  std::string picture = {};
  double degrees_off = 0.0;  ///< its direction of the one that was given, about

  /// Whatever of it.
  [[nodiscard]] bool interrupted() const;
};

/// Counts the rows; the rest of the report is the caller's.
void count(const Insertion& insertion, InsertReport& report);

[[nodiscard]] std::string readable(const InsertReport& report);

/// What of it a reader of the page wants to know.
[[nodiscard]] std::vector<ReportLine> report_lines(const InsertReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const InsertReport& report);

}  // namespace verisq::command_line
