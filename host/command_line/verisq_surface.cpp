/// The program `verisq-surface`, which is `verisq surface`: a closed oriented surface from a point cloud, a damaged
/// mesh or a label of a volume, and the canal within one.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/surface.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "verify/numbers/points.hpp"

namespace verisq::command_line {
namespace {

// The surface of a label of a volume that a command is given.

struct LabelInput {
  std::uint16_t label;
  AnatomicalSpace space;
  double voxel_volume;   ///< volume of one voxel
  Point voxel_lengths;   ///< lengths of its sides
  LabelSurface surface;  ///< its triangles are small against the voxels
};

// Options that say how thick a cortex is: --thickness, once or by heights, --axis.

// The summary of a prepared surface on the standard output: for people, or as one JSON object.

struct SurfaceReport {
  const PreparedSurface& surface;
  const SurfaceCheck& check;  ///< check of the file
  const SurfaceOptions& options;
  std::size_t points;             ///< number of the input's points
  const LabelInput* label;        ///< null where the input is no volume
  std::optional<WallCheck> wall;  ///< for a canal
  std::string output;             ///< the file
  double seconds;
};

// `verisq surface`, which is the program `verisq-surface`: a closed oriented surface from a point cloud, a damaged
// mesh or a label of a volume, and the canal within one.

/// As typed; `run_surface` checks what depends on several options.
struct SurfaceArguments {
  std::string points;  ///< one of three is given, the others are empty
  std::string mesh;
  std::string volume;
  std::string output;
  std::optional<std::uint16_t> label;
  std::optional<AnatomicalSpace> space;
  std::vector<std::string> thickness;
  std::optional<Point> axis;
  std::string landmarks;  ///< empty where heights are numbers
  std::optional<SurfaceMethod> method;
  std::optional<double> alpha;
  std::optional<double> offset;
  bool fill_holes = false;
  std::optional<int> smooth;
  std::optional<double> edge;
  std::optional<Plane> resection;
  bool inward = false;
  bool outward = false;
  bool json = false;
  bool no_progress = false;
};

/// "1 (250 voxels), 2 (17 voxels)".
std::string listed(const std::vector<LabelCount>& labels) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(labels.size(), most); ++k)
    text += fmt::format("{}{} ({} voxels)", k == 0 ? "" : ", ", labels[k].label, labels[k].voxels);
  if (labels.size() > most) text += fmt::format(" and {} more", labels.size() - most);
  return text;
}

std::uint16_t chosen(const std::string& volume, const std::vector<LabelCount>& labels,
                     std::optional<std::uint16_t> label) {
  if (labels.empty()) refuse(fmt::format("{}: all of its voxels are 0, the background", volume));
  if (!label && labels.size() == 1) return labels.front().label;
  if (!label) refuse(fmt::format("{}: give --label, one of {}", volume, listed(labels)));
  if (std::ranges::find(labels, *label, &LabelCount::label) == labels.end())
    refuse(fmt::format("--label: {} has no label {}, but {}", volume, *label, listed(labels)));
  return *label;
}

/// Throws Error(input), which names the labels of the file where `label` is not one of them or is missing, and there
/// are several; and where `space` is asked for of a file that does not say which one it is in. Without it: LPS.
LabelInput read_label(const std::string& name, std::optional<std::uint16_t> label,
                      std::optional<AnatomicalSpace> space) {
  LabelVolume volume = read_label_volume(name);
  const std::uint16_t one = chosen(name, labels_of(volume), label);
  if (space && volume.space == AnatomicalSpace::unknown)
    refuse(fmt::format("--space: {} does not say in which space its coordinates are", name));
  if (space) volume = in_space(std::move(volume), *space);
  Point lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    lengths[axis] = std::hypot(volume.steps[axis][0], volume.steps[axis][1], volume.steps[axis][2]);
  return {.label = one,
          .space = volume.space,
          .voxel_volume = voxel_volume(volume),
          .voxel_lengths = lengths,
          .surface = label_surface(volume, one)};
}

constexpr std::string_view option = "--thickness";

Point axis_of(const std::optional<Point>& given, const FemurLandmarks& landmarks) {
  if (given) return *given;
  if (!landmarks.shaft_distal || !landmarks.shaft_proximal) return {0.0, 0.0, 1.0};
  Point axis{};
  for (std::size_t i = 0; i < 3; ++i) axis[i] = (*landmarks.shaft_proximal)[i] - (*landmarks.shaft_distal)[i];
  if (axis == Point{}) refuse("--landmarks: both ends of the shaft are the same point, which has no axis; give --axis");
  return axis;
}

double height_of(const Point& x, const Point& axis) {
  const auto [along_x, along_y, along_z] = verify::near_one(axis);
  return (x[0] * along_x + x[1] * along_y + x[2] * along_z) / std::hypot(along_x, along_y, along_z);
}

double height_of(const std::string& at, const std::string& text, const Point& axis, const FemurLandmarks& landmarks) {
  const auto* const named = std::ranges::find_if(named_landmarks, [&at](const auto& one) { return at == one.name; });
  if (named == named_landmarks.end()) return parse_numbers(option, at, "AT").front();
  if (const std::optional<Point>& point = landmarks.*named->point) return height_of(*point, axis);
  refuse(fmt::format("{}: {}: --landmarks has no {}", option, text, at));
}

/// The thickness from `texts`, at least one: "T" alone, or several "AT,T", where AT is a height along `axis` or the
/// name of a landmark that has one. Without `axis` heights are along the landmarks' shaft, from its distal to its
/// proximal end, if they name both, else along z. Ascending, whatever their order. Throws Error(input).
CorticalThickness thickness_of(const std::vector<std::string>& texts, const std::optional<Point>& axis,
                               const FemurLandmarks& landmarks) {
  CorticalThickness thickness{.at = {}, .axis = axis_of(axis, landmarks)};
  for (const std::string& text : texts) {
    const std::size_t comma = text.rfind(',');
    if (comma == std::string::npos && texts.size() > 1)
      refuse(fmt::format("{}: {} has no height: of several each is AT,T", option, text));
    const std::string at = comma == std::string::npos ? "0" : text.substr(0, comma);
    const std::string value = comma == std::string::npos ? text : text.substr(comma + 1);
    thickness.at.push_back({height_of(at, text, thickness.axis, landmarks), parse_positive_length(option, value)});
  }
  std::ranges::sort(thickness.at, {}, &ThicknessAtHeight::height);
  const auto twice = std::ranges::adjacent_find(thickness.at, {}, &ThicknessAtHeight::height);
  if (twice != thickness.at.end()) refuse(fmt::format("{}: height {} is given twice", option, twice->height));
  return thickness;
}

const char* name(SurfaceMethod method) {
  switch (method) {
    case SurfaceMethod::given: return "given mesh";
    case SurfaceMethod::wrap: return "alpha wrap";
    case SurfaceMethod::alpha_shape: break;
  }
  return "alpha shape";
}

std::string_view name(AnatomicalSpace space) {
  switch (space) {
    case AnatomicalSpace::lps: return "LPS";
    case AnatomicalSpace::ras: return "RAS";
    case AnatomicalSpace::unknown: break;
  }
  return "unknown";
}

const char* yes_or_no(bool fact) {
  return fact ? "yes" : "no";
}

/// The name of the method that made the surface.
const char* method_of(const SurfaceReport& report) {
  if (report.wall) return "canal";
  return report.label != nullptr ? "label" : name(report.options.method);
}

std::string about_label(const LabelInput& input) {
  const auto& [x, y, z] = input.voxel_lengths;
  return fmt::format(
      "label              {}, {} voxels of {:.4g} x {:.4g} x {:.4g}: volume {:.6g}\n"
      "space              {}\n",
      input.label, input.surface.voxels, x, y, z, static_cast<double>(input.surface.voxels) * input.voxel_volume,
      name(input.space));
}

std::string how_made(const SurfaceReport& report) {
  std::string text = report.label != nullptr ? about_label(*report.label) : "";
  text += fmt::format("input points       {}\nmethod             {}", report.points, method_of(report));
  if (report.options.edge) text += fmt::format(", edges about {:.4g}", *report.options.edge);
  if (report.surface.alpha) text += fmt::format(", alpha {:.6g}", *report.surface.alpha);
  if (report.surface.offset) text += fmt::format(", offset {:.6g}", *report.surface.offset);
  text += "\n";
  if (report.options.fill_holes)
    text += fmt::format("holes filled       {} of {}\n", report.surface.holes_filled, report.surface.holes);
  if (report.options.smoothing_rounds > 0) {
    const double before = report.surface.volume_before_smoothing;
    const double after = report.surface.volume;
    text += fmt::format("smoothing          {} rounds, volume {:.6g} to {:.6g} ({:+.3g} %)\n",
                        report.options.smoothing_rounds, before, after, 100.0 * (after - before) / before);
  }
  return text;
}

JsonValue wall_of(const SurfaceReport& report) {
  if (!report.wall) return {};
  const auto& [least, mean, largest, error] = *report.wall;
  return JsonObject{{"least", least}, {"mean", mean}, {"largest", largest}, {"largest_error", error}};
}

const char* word(Facing facing) {
  return facing == Facing::inward ? "inward" : "outward";
}

std::string readable(const SurfaceReport& report) {
  const MeshTopology& topology = report.check.topology;
  std::string text = how_made(report);
  text += fmt::format("vertices           {}\ntriangles          {}\n", topology.vertices, topology.triangles);
  text += fmt::format("closed             {}\nmanifold           {}\n", yes_or_no(topology.closed()),
                      yes_or_no(topology.manifold()));
  text +=
      fmt::format("oriented           {}, normals {}\n", yes_or_no(topology.oriented()), word(report.options.facing));
  text += fmt::format("self-intersections {}\n", yes_or_no(report.check.self_intersecting));
  text += fmt::format("components         {}\n", topology.components);
  if (report.check.rims > 0) text += fmt::format("rims               {}\n", report.check.rims);
  text += fmt::format("Euler character.   {}", topology.euler_characteristic());
  if (const auto genus = topology.genus()) text += fmt::format(", genus {}", *genus);
  text += topology.closed() ? fmt::format("\nvolume             {:.10g}\n", report.check.volume) : "\n";
  if (report.wall) {
    text +=
        fmt::format("wall               {:.4g} to {:.4g} thick, mean {:.4g}; at most {:.2g} off what is asked for\n",
                    report.wall->least, report.wall->largest, report.wall->mean, report.wall->largest_error);
  } else if (report.label == nullptr) {
    text += fmt::format("farthest point     {:.4g} from the surface\n", report.check.farthest_point);
  }
  text += fmt::format("time               {:.3g} s\nsurface            {}\n", report.seconds, quotation(report.output));
  return text;
}

/// One line.
std::string json(const SurfaceReport& report) {
  const MeshTopology& topology = report.check.topology;
  const LabelInput* const label = report.label;
  const bool is_of_points = label == nullptr && !report.wall;
  const JsonObject object{
      {"points", report.points},
      {"method", method_of(report)},
      {"label", label != nullptr ? JsonValue(label->label) : JsonValue()},
      {"space", label != nullptr ? JsonValue(name(label->space)) : JsonValue()},
      {"voxels", label != nullptr ? JsonValue(label->surface.voxels) : JsonValue()},
      {"voxels_at_border", label != nullptr ? JsonValue(label->surface.voxels_at_border) : JsonValue()},
      {"voxel_volume", label != nullptr ? JsonValue(label->voxel_volume) : JsonValue()},
      {"edge", report.options.edge},
      {"alpha", report.surface.alpha},
      {"offset", report.surface.offset},
      {"holes", report.surface.holes},
      {"holes_filled", report.surface.holes_filled},
      {"smoothing_rounds", report.options.smoothing_rounds},
      {"volume_before_smoothing", report.surface.volume_before_smoothing},
      {"facing", word(report.options.facing)},
      {"vertices", topology.vertices},
      {"edges", topology.edges},
      {"triangles", topology.triangles},
      {"closed", topology.closed()},
      {"rims", report.check.rims},
      {"manifold", topology.manifold()},
      {"oriented", topology.oriented()},
      {"boundary_edges", topology.boundary_edges},
      {"non_manifold_edges", topology.non_manifold_edges},
      {"non_manifold_vertices", topology.non_manifold_vertices},
      {"inconsistent_edges", topology.inconsistent_edges},
      {"self_intersecting", report.check.self_intersecting},
      {"components", topology.components},
      {"euler_characteristic", topology.euler_characteristic()},
      {"genus", topology.genus()},
      {"volume", topology.closed() ? JsonValue(report.check.volume) : JsonValue()},
      {"farthest_point", is_of_points ? JsonValue(report.check.farthest_point) : JsonValue()},
      {"wall", wall_of(report)},
      {"seconds", report.seconds},
      {"output", report.output},
  };
  return object.text() + "\n";
}

constexpr const char* closing_words = R"(Points become a surface by one of two methods:
  wrap   (default) an alpha wrap: around the points, or around a mesh's triangles in whatever state they are. It
         keeps a small distance, the offset, from them.
  alpha  an alpha shape: through the points themselves. Its largest component, without voids inside; tetrahedra
         are added where it would be no manifold.
Both carve space away by balls of the radius --alpha. The smaller, the more detail; but it must exceed the gaps
between points, or the balls break in, and the volume printed collapses. Left out, it is chosen: of alpha shapes
the least that gives a filled solid; of wraps the least of diagonal/20 times 2^(-k/2), k = 0 to 4, before they
break in. A mesh without --method keeps its own triangles, turned alike, its holes filled with --fill-holes.

A label of a volume becomes a surface where its share of the neighbourhood, weighed with a Gaussian of 0.7
voxels, is a half; its triangles are then made of about equal sides and smoothed. Its coordinates are in LPS (x to
the patient's left, y to the back) like meshes that 3D Slicer exports, or with --space ras in RAS. It is an input,
no proof: where the tissue ends nobody knows to less than about a voxel.

With --thickness the result is the canal of the bone: all that lies farther inside than the cortex is thick, its
normals inward, so that `verisq fit --cavity` takes it. The thickness is the same everywhere, T, or given at
several heights AT,T: linear between them, constant beyond. It says what the user knows, not what the patient has.
An open bone is closed over its rims, and there the canal has no cortex.

The file is read again and checked: closed (or with --resection open there), manifold, consistently oriented;
self-intersections, the volume (negative where normals point inward), and the largest distance of an input point
or the thickness of the wall around the canal are reported, in floating point: no enclosures.

Exit status: 0 closed (with --resection but for one rim), manifold and oriented, with 90 % of the volume of a
label's voxels; 3 written, but not so; 2 bad usage or input.

Examples:
  verisq surface --points cavity.csv --smooth 5 --inward -o cavity.ply
  verisq surface --mesh open_femur.stl --fill-holes -o femur.ply
  verisq surface --volume femur.nrrd --label 2 --inward -o canal.ply
  verisq surface --mesh femur.stl --thickness -80,6 --thickness 20,2 --resection 0,0,40,0.5,0,1 -o canal.ply)";

/// Smooths away the steps between voxels, which are longer than a Gaussian of less than a voxel reaches.
constexpr int rounds_of_volumes = 20;
/// A share of the voxels' volume. A femur's cortex in voxels of 0.8 mm loses 0.1 %.
constexpr double most_volume_lost = 0.1;
/// The edges of triangles relative to the samples: sides of a cube as large as a voxel, or the distance of a canal's
/// samples.
constexpr double edge_of_samples = 1.5;

void check_inputs(const SurfaceArguments& arguments) {
  const int given = static_cast<int>(!arguments.points.empty()) + static_cast<int>(!arguments.mesh.empty()) +
                    static_cast<int>(!arguments.volume.empty());
  if (given != 1) refuse("give one of --points, --mesh and --volume");
  if (arguments.inward && arguments.outward) refuse("give either --inward or --outward");
  if (arguments.volume.empty() && arguments.label) refuse("--label: is for --volume");
  if (arguments.volume.empty() && arguments.space) refuse("--space: is for --volume");
  if (!arguments.volume.empty() && arguments.method) refuse("--method: a label of --volume has its surface");
  if (!arguments.thickness.empty() && !arguments.points.empty())
    refuse("--thickness: needs the surface of a bone, --mesh or --volume");
  if (!arguments.thickness.empty() && (arguments.method || arguments.fill_holes))
    refuse("--thickness: the canal is that of the surface as it is; mend it first, by itself");
  if (arguments.thickness.empty() && arguments.axis) refuse("--axis: is for --thickness");
  if (arguments.thickness.empty() && !arguments.landmarks.empty()) refuse("--landmarks: is for --thickness");
}

SurfaceOptions options_of(const SurfaceArguments& arguments) {
  check_inputs(arguments);
  SurfaceOptions options;
  // An input with triangles keeps them unless a method is named.
  options.method = arguments.method.value_or(arguments.points.empty() ? SurfaceMethod::given : SurfaceMethod::wrap);
  options.alpha = arguments.alpha;
  options.offset = arguments.offset;
  options.fill_holes = arguments.fill_holes;
  options.smoothing_rounds = arguments.smooth.value_or(arguments.volume.empty() ? 0 : rounds_of_volumes);
  options.opening = arguments.resection;
  options.edge = arguments.edge;
  const bool is_cavity = arguments.inward || (!arguments.thickness.empty() && !arguments.outward);
  options.facing = is_cavity ? Facing::inward : Facing::outward;
  if (options.fill_holes && (options.method != SurfaceMethod::given || !arguments.volume.empty()))
    refuse("--fill-holes: is for the triangles of --mesh without --method; other surfaces have no holes");
  if (options.alpha && options.method == SurfaceMethod::given) refuse("--alpha: needs --method");
  if (options.offset && options.method != SurfaceMethod::wrap) refuse("--offset: is for --method wrap");
  return options;
}

Mesh read_input(const SurfaceArguments& arguments) {
  return arguments.mesh.empty() ? read_cloud(arguments.points) : read_mesh(arguments.mesh);
}

/// The surface of a label as a bone has it: equal triangles, no steps.
Mesh surface_of(const LabelInput& input, double edge, int rounds) {
  return prepare_surface(input.surface.mesh, {.method = SurfaceMethod::given, .smoothing_rounds = rounds, .edge = edge})
      .mesh;
}

CorticalThickness read_thickness(const SurfaceArguments& arguments) {
  const FemurLandmarks landmarks =
      arguments.landmarks.empty() ? FemurLandmarks{} : read_landmarks(arguments.landmarks).landmarks;
  return thickness_of(arguments.thickness, arguments.axis, landmarks);
}

/// The kind of option that is taken apart later.
std::string plain_text(std::string_view /*option*/, const std::string& text) {
  return text;
}

/// A step of how many there may be: reading is done by then.
void show_steps(SurfaceOptions& options, std::optional<ProgressBar>& bar) {
  const int steps = 2 + (options.fill_holes ? 1 : 0) + (options.smoothing_rounds > 0 ? 1 : 0) + (options.edge ? 1 : 0) +
                    (options.opening ? 1 : 0);
  options.progress = [&bar, steps, done = std::uint64_t{0}](std::string_view /*step*/) mutable {
    bar->update(done, static_cast<double>(done) / steps);
    ++done;
  };
}

void explain(const SurfaceCheck& check, const SurfaceOptions& options, const std::string& output) {
  const MeshTopology& topology = check.topology;
  std::string faults;
  const auto add = [&faults](std::size_t count, const char* what) {
    if (count > 0) faults += fmt::format("{}{} {}", faults.empty() ? "" : ", ", count, what);
  };
  if (!options.opening || check.rims != 1) add(topology.boundary_edges, "boundary edges");
  add(topology.non_manifold_edges, "non-manifold edges");
  add(topology.non_manifold_vertices, "non-manifold vertices");
  add(topology.inconsistent_edges, "edges between triangles turned against each other");
  if (!faults.empty()) tell(fmt::format("{} bounds no solid: {}", output, faults));
  if (check.self_intersecting) tell(fmt::format("{} intersects itself", output));
}

void declare_surface(Options& options, SurfaceArguments& arguments) {
  options.explain(closing_words);
  options.add("--points", arguments.points, "FILE",
              "Point cloud: text with x,y,z a line, .npy, or a mesh (.stl, .obj, .ply, .off, .vtp, .vtk), whose "
              "vertices count");
  options.add("--mesh", arguments.mesh, "FILE", "Instead of --points: a mesh, whose triangles count");
  options.add("--volume", arguments.volume, "FILE",
              "Instead of --points: labels of voxels, .nrrd (3D Slicer) or .nii, .nii.gz (NIfTI)");
  options.require("-o,--output", arguments.output, "FILE",
                  "The surface: .ply, .stl (rounded to binary32), .off or .obj");
  options.add("--label", arguments.label, whole_number<std::uint16_t>(1, 65535), "N",
              "The label of --volume (default: the only one; of several they are listed)");
  options.add("--space", arguments.space,
              choice<AnatomicalSpace>({{"lps", AnatomicalSpace::lps}, {"ras", AnatomicalSpace::ras}}), "SPACE",
              "Coordinates of the surface of --volume: lps (default) or ras");
  options.add_each("--thickness", arguments.thickness, plain_text, "[AT,]T",
                   "The canal of a bone whose cortex is T thick; with AT at this height, or at this landmark's; "
                   "repeatable");
  options.add("--axis", arguments.axis, parse_direction, "x,y,z",
              "Along which heights are taken (default: the landmarks' shaft, else z)");
  options.add("--landmarks", arguments.landmarks, "FILE", "Landmarks of a femur, whose names may stand for heights");
  options.add("--method", arguments.method,
              choice<SurfaceMethod>({{"wrap", SurfaceMethod::wrap}, {"alpha", SurfaceMethod::alpha_shape}}), "METHOD",
              "wrap (default of --points) or alpha");
  options.add("--alpha", arguments.alpha, parse_positive_length, "LENGTH",
              "Radius of the carving balls (default: chosen, see below)");
  options.add("--offset", arguments.offset, parse_positive_length, "LENGTH",
              "How far a wrap keeps from its input (default alpha/100)");
  options.add_flag("--fill-holes", arguments.fill_holes, "Fill the holes of --mesh");
  options.add("--smooth", arguments.smooth, whole_number(0), "ROUNDS",
              "Rounds of Taubin's smoothing, which keeps the volume (default 0, of --volume 20)");
  options.add(
      "--edge", arguments.edge, parse_positive_length, "LENGTH",
      "Triangles of about equal sides, this long (default: as they come; of --volume 1.5 voxels, of a canal 1.5 "
      "times its samples' distance, a 200th of the bone's length or half the cortex)");
  options.add("--resection", arguments.resection, parse_plane, "x,y,z,nx,ny,nz",
              "Cut off and left open: what lies beyond this plane, by a point and a normal");
  options.add_flag("--outward", arguments.outward, "Normals point out of the solid (default but of canals)");
  options.add_flag("--inward", arguments.inward, "Normals point into it, as for cavities (default of canals)");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// The input prepared by the options, and the messages about it.
struct Prepared {
  Mesh input;
  std::optional<LabelInput> label;
  std::optional<CorticalThickness> thickness;
  std::optional<Canal> canal;
};

Prepared prepared_input(const SurfaceArguments& arguments, SurfaceOptions& options) {
  Prepared input;
  if (!arguments.thickness.empty()) input.thickness = read_thickness(arguments);  // before what takes long
  if (arguments.volume.empty()) {
    input.input = read_input(arguments);
  } else {
    input.label = read_label(arguments.volume, arguments.label, arguments.space);
    const double edge = edge_of_samples * std::cbrt(input.label->voxel_volume);
    if (!input.thickness) {
      input.input = std::move(input.label->surface.mesh);
      if (!options.edge) options.edge = edge;
    } else {
      input.input = surface_of(*input.label, edge, options.smoothing_rounds);
    }
  }
  if (!input.thickness) return input;
  CanalOptions canal{.thickness = *input.thickness};
  if (options.edge) canal.spacing = *options.edge / edge_of_samples;
  input.canal = canal_of(input.input, canal);
  options.edge = edge_of_samples * input.canal->spacing;
  if (!arguments.smooth) options.smoothing_rounds = 0;
  return input;
}

/// Reports the parts that were left out of the input, or added to it.
void tell_what_differs(const Prepared& input, const PreparedSurface& surface) {
  if (input.label && input.label->surface.parts_left_out > 0)
    tell(fmt::format("label {}: {} smaller parts or voids are left out", input.label->label,
                     input.label->surface.parts_left_out));
  if (input.label && input.label->surface.voxels_at_border > 0)
    tell(fmt::format("label {}: {} of its voxels are at the border of the volume, where the surface is closed",
                     input.label->label, input.label->surface.voxels_at_border));
  if (input.canal && input.canal->rims_closed > 0)
    tell(fmt::format("the bone is open: closed over {} rim{}, where its canal has no cortex", input.canal->rims_closed,
                     input.canal->rims_closed == 1 ? "" : "s"));
  if (input.canal && input.canal->parts_left_out > 0)
    tell(fmt::format("the canal falls apart: {} smaller parts are left out", input.canal->parts_left_out));
  if (surface.parts_left_out > 0)
    tell(fmt::format("--resection: {} smaller parts are left out", surface.parts_left_out));
}

/// How much smaller the surface's volume is than that of the label's voxels, as a share of that; nothing if the surface
/// is not the whole surface of that label.
std::optional<double> volume_lost(const Prepared& input, const SurfaceCheck& check, const SurfaceOptions& options) {
  if (!input.label || input.canal || options.opening || !check.topology.closed()) return std::nullopt;
  const double voxels = static_cast<double>(input.label->surface.voxels) * input.label->voxel_volume;
  return 1.0 - std::abs(check.volume) / voxels;
}

/// Says so, and returns true, where more is lost than a surface of fine voxels ever loses.
bool is_hollowed_out(const Prepared& input, const SurfaceCheck& check, const SurfaceOptions& options) {
  const std::optional<double> lost = volume_lost(input, check, options);
  if (!lost || *lost <= most_volume_lost) return false;
  tell(
      fmt::format("label {}: the surface has lost {:.0f} % of the volume of its voxels, more than {:.0f} %: they are "
                  "too coarse for what is thin, or parts are left out",
                  input.label->label, 100.0 * *lost, 100.0 * most_volume_lost));
  return true;
}

bool is_as_asked(const SurfaceCheck& check, const SurfaceOptions& options) {
  const MeshTopology& topology = check.topology;
  if (!options.opening || topology.closed()) return topology.bounds_solid();
  return topology.manifold() && topology.oriented() && check.rims == 1;
}

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_surface(const SurfaceArguments& arguments) {
  SurfaceOptions options = options_of(arguments);
  check_mesh_name(arguments.output);
  refuse_to_overwrite("-o", arguments.output,
                      {arguments.points, arguments.mesh, arguments.volume, arguments.landmarks});
  const Stopwatch time;
  const Prepared input = prepared_input(arguments, options);
  const Mesh& from = input.canal ? input.canal->mesh : input.input;

  std::optional<ProgressBar> bar(std::in_place, !arguments.no_progress, "steps");
  show_steps(options, bar);
  const PreparedSurface surface = prepare_surface(from, options);
  options.progress("checking");
  write_mesh(arguments.output, surface.mesh);
  // The file counts: STL merges and rounds vertices.
  const Mesh written = read_mesh(arguments.output);
  const bool is_of_points = !input.label && !input.canal;
  const SurfaceCheck check = check_surface(written, is_of_points ? std::span(from.vertices) : std::span<const Point>());
  std::optional<WallCheck> wall;
  if (input.canal) wall = check_wall(written, input.input, *input.thickness);
  bar.reset();  // the line is cleared before anything else is said

  tell_what_differs(input, surface);
  explain(check, options, arguments.output);
  const bool hollowed_out = is_hollowed_out(input, check, options);
  const SurfaceReport report{.surface = surface,
                             .check = check,
                             .options = options,
                             .points = input.input.vertices.size(),
                             .label = input.label ? &*input.label : nullptr,
                             .wall = wall,
                             .output = arguments.output,
                             .seconds = time.seconds()};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return is_as_asked(check, options) && !hollowed_out ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace
}  // namespace verisq::command_line

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const std::array commands{command("surface", surface_description, declare_surface, run_surface)};
  if (argc > 0 && std::string_view(argv[0]) == name_of_caller) {
    return run_program({.name = name_of_caller, .description = ""}, commands, argc, argv);
  }
  const Program program{.name = "verisq-surface", .description = surface_description};
  return run_program(program, commands.front(), argc, argv);
}
