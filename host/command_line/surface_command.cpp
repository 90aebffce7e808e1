/// Reads the options and the points of `verisq surface`, prepares the surface, writes it, checks the file, reports.
#include "host/command_line/surface_command.hpp"

#include <fmt/core.h>

#include <verisq/mesh_file.hpp>
#include <verisq/surface.hpp>

#include "host/command_line/choice.hpp"
#include "host/command_line/cloud_input.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/refusal.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/command_line/surface_summary.hpp"
#include "host/command_line/whole_number.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Points become a surface by one of two methods:\n"
    "  wrap   (default) an alpha wrap: around the points, or around a mesh's triangles in whatever state they are. It\n"
    "         keeps a small distance, the offset, from them.\n"
    "  alpha  an alpha shape: through the points themselves. Its largest component, without voids inside; tetrahedra\n"
    "         are added where it would be no manifold.\n"
    "Both carve space away by balls of the radius --alpha. The smaller, the more detail; but it must exceed the gaps\n"
    "between points, or the balls break in, and the volume printed collapses. Left out, it is chosen: of alpha shapes\n"
    "the least that gives a filled solid; of wraps the least of diagonal/20 times 2^(-k/2), k = 0 to 4, before they\n"
    "break in. A mesh without --method keeps its own triangles, turned alike, its holes filled with --fill-holes.\n"
    "\n"
    "The file is read again and checked: closed, manifold, consistently oriented; self-intersections, the volume\n"
    "(negative where normals point inward) and the largest distance of an input point are reported, in floating\n"
    "point: no enclosures.\n"
    "\n"
    "Exit status: 0 closed, manifold and oriented; 3 written, but not so; 2 bad usage or input.\n"
    "\n"
    "Examples:\n"
    "  verisq surface --points cavity.csv --smooth 5 --inward -o cavity.ply\n"
    "  verisq surface --mesh open_femur.stl --fill-holes -o femur.ply";

SurfaceOptions options_of(const SurfaceArguments& arguments) {
  if (arguments.points.empty() == arguments.mesh.empty()) refuse("give either --points or --mesh");
  if (arguments.inward && arguments.outward) refuse("give either --inward or --outward");
  SurfaceOptions options;
  // A given mesh keeps its triangles unless a method is named.
  options.method = arguments.method.value_or(arguments.mesh.empty() ? SurfaceMethod::wrap : SurfaceMethod::given);
  options.alpha = arguments.alpha;
  options.offset = arguments.offset;
  options.fill_holes = arguments.fill_holes;
  options.smoothing_rounds = arguments.smooth;
  options.facing = arguments.inward ? Facing::inward : Facing::outward;
  if (options.fill_holes && options.method != SurfaceMethod::given)
    refuse("--fill-holes: is for the triangles of --mesh without --method; other surfaces have no holes");
  if (options.alpha && options.method == SurfaceMethod::given) refuse("--alpha: needs --method");
  if (options.offset && options.method != SurfaceMethod::wrap) refuse("--offset: is for --method wrap");
  return options;
}

Mesh read_input(const SurfaceArguments& arguments) {
  return arguments.mesh.empty() ? read_cloud(arguments.points) : read_mesh(arguments.mesh);
}

/// A step of how many there may be: reading is done by then.
void show_steps(SurfaceOptions& options, std::optional<ProgressBar>& bar) {
  const int steps = 2 + (options.fill_holes ? 1 : 0) + (options.smoothing_rounds > 0 ? 1 : 0);
  options.progress = [&bar, steps, done = std::uint64_t{0}](std::string_view /*step*/) mutable {
    bar->update(done, static_cast<double>(done) / steps);
    ++done;
  };
}

void explain(const SurfaceCheck& check, const std::string& output) {
  const MeshTopology& topology = check.topology;
  std::string faults;
  const auto add = [&faults](std::size_t count, const char* what) {
    if (count > 0) faults += fmt::format("{}{} {}", faults.empty() ? "" : ", ", count, what);
  };
  add(topology.boundary_edges, "boundary edges");
  add(topology.non_manifold_edges, "non-manifold edges");
  add(topology.non_manifold_vertices, "non-manifold vertices");
  add(topology.inconsistent_edges, "edges between triangles turned against each other");
  if (!faults.empty()) tell(fmt::format("{} bounds no solid: {}", output, faults));
  if (check.self_intersecting) tell(fmt::format("{} intersects itself", output));
}

}  // namespace

void declare_surface(Options& options, SurfaceArguments& arguments) {
  options.explain(closing_words);
  options.add("--points", arguments.points, "FILE",
              "Point cloud: text with x,y,z a line, .npy, or a mesh (.stl, .ply, .off, .obj), whose vertices count");
  options.add("--mesh", arguments.mesh, "FILE", "Instead of --points: a mesh, whose triangles count");
  options.require("-o,--output", arguments.output, "FILE",
                  "The surface: .ply, .stl (rounded to binary32), .off or .obj");
  options.add("--method", arguments.method,
              choice<SurfaceMethod>({{"wrap", SurfaceMethod::wrap}, {"alpha", SurfaceMethod::alpha_shape}}), "METHOD",
              "wrap (default of --points) or alpha");
  options.add("--alpha", arguments.alpha, parse_positive_length, "LENGTH",
              "Radius of the carving balls (default: chosen, see below)");
  options.add("--offset", arguments.offset, parse_positive_length, "LENGTH",
              "How far a wrap keeps from its input (default alpha/100)");
  options.add_flag("--fill-holes", arguments.fill_holes, "Fill the holes of --mesh");
  options.add("--smooth", arguments.smooth, whole_number(0), "ROUNDS",
              "Rounds of Taubin's smoothing, which keeps the volume (default 0)");
  options.add_flag("--outward", arguments.outward, "Normals point out of the solid (default)");
  options.add_flag("--inward", arguments.inward, "Normals point into it, as for cavities");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_surface(const SurfaceArguments& arguments) {
  SurfaceOptions options = options_of(arguments);
  check_mesh_name(arguments.output);
  refuse_to_overwrite("-o", arguments.output, {arguments.points, arguments.mesh});
  const Stopwatch time;
  const Mesh input = read_input(arguments);

  std::optional<ProgressBar> bar(std::in_place, !arguments.no_progress, "steps");
  show_steps(options, bar);
  const PreparedSurface surface = prepare_surface(input, options);
  options.progress("checking");
  write_mesh(arguments.output, surface.mesh);
  // What counts is what the file says: STL merges and rounds vertices.
  const SurfaceCheck check = check_surface(read_mesh(arguments.output), input.vertices);
  bar.reset();  // the line is cleared before anything else is said

  explain(check, arguments.output);
  const SurfaceReport report{.surface = surface,
                             .check = check,
                             .options = options,
                             .points = input.vertices.size(),
                             .output = arguments.output,
                             .seconds = time.seconds()};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return check.topology.bounds_solid() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
