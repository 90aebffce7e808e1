/// `verisq stance`: its options, its runs, and the certificate of an equilibrium.
#include "host/command_line/stance_command.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <utility>
#include <verisq/certificate_file.hpp>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"
#include "host/stance/stance_results.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

using stance::CertifiedEquilibrium;

CertifiedEquilibrium certified(const StanceSummary& summary, bool no_progress) {
  ProgressBar bar(!no_progress, "%");
  return stance::certified_equilibrium(summary.model, summary.uncertain, summary.control, *summary.equilibrium,
                                       {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                        .interrupted = interrupted,
                                        .progress = [&bar](double done) { bar.update_state("certificates", done); }});
}

}  // namespace

void certify_equilibrium(const std::string& file, StanceSummary& summary, bool no_progress) {
  CertifiedEquilibrium found = certified(summary, no_progress);
  if (found.interrupted) return tell(fmt::format("interrupted; {} is not written", file));
  if (found.left_out > 0) {
    tell(fmt::format(
        "{}: says nothing of {} cells that are found to stand, or of parts of them: the proof that it holds "
        "does not reach there",
        file, found.left_out));
  }
  EquilibriumAnswer answer{.model = subject_file(summary.file),
                           .parameters = {},
                           .joints = joint_names(summary.model),
                           .cylinders = {},
                           .claims = found.claims,
                           .certificate = std::move(found.certificate)};
  for (const std::uint32_t k : summary.uncertain) answer.parameters.push_back(summary.model.parameters[k].name);
  for (const stance::ContactCylinder& cylinder : summary.model.cylinders) answer.cylinders.push_back(cylinder.name);
  write_answer(file, std::move(answer));
  summary.certificate = file;
  summary.certified = std::move(found.claims);
}

namespace {

using namespace stance;

constexpr const char* closing_words =
    R"(Prints enclosures of the wrench on the model's root (w1, w2, w3: forces; w4, w5, w6: moments) over the box of the
uncertain parameters; the others are at their nominal values. What is asked for besides follows. Printed digits
are rounded outward. The model's format: docs/stance.md.

The wrench is that of gravity and the applied force alone, at rest; in the accelerations the body falls freely,
legs hanging, unless they are asked for in contact or standing: then the ground presses on the body at rest. In
--equilibrium forces balance on the cylinders, at rest: whether the body stays there or topples is what
--stability says. In --simulate all of it acts, and the body moves in its sagittal plane. --bounce drops
one cylinder alone, with nobody standing on it. Each result says below it what acts in it, what does not, and
which parameters have no effect on it.

Exit status: 0 all is proven; 1 a sample escapes from an enclosure, which is a defect, or the program failed;
2 bad usage or input; 3 something stayed unproven (an infinite end), or not all of the box is proven to have an
equilibrium, or to be stable, or the motion is open before its end, or a cell of --report differs; 130
interrupted by Ctrl-C, with what was proven so far.

Examples:
  verisq stance stance.xml --monte-carlo 1000000
  verisq stance stance.xml --uncertain mp,px,Fx --sensitivities
  verisq stance stance.xml --accelerations --monte-carlo 100000
  verisq stance standing.xml --accelerations standing
  verisq stance standing.xml --uncertain mp,px --equilibrium held
  verisq stance standing.xml --uncertain mp,px --within 1 --stability held
  verisq stance standing.xml --uncertain none --simulate 1 --push 50,0.05,0.2 --csv motion.csv --plot motion.svg
  verisq stance standing.xml --uncertain mp,px --within 1 --equilibrium held --stability held --simulate 0.5
    --report standing.html
  verisq stance stance.xml --report)";

constexpr double default_drop_height = 0.01;  // m
constexpr std::uint32_t most_cells = 4096;

void check_report_usage(const StanceArguments& arguments) {
  const bool other = arguments.uncertain || arguments.mode || arguments.sensitivities ||
                     arguments.accelerations.given || arguments.monte_carlo || arguments.bounce ||
                     arguments.equilibrium || arguments.stability || arguments.within || arguments.simulate ||
                     !arguments.ranges.empty();
  const bool page = !arguments.report.text.empty();
  if (arguments.report.given && !page && other)
    refuse("--report: chooses parameters and mode itself; give --json at most");
  if (page && !arguments.equilibrium && !arguments.stability && !arguments.simulate)
    refuse(fmt::format("--report {}: give --equilibrium, --stability or --simulate, which the page shows",
                       arguments.report.text));
  if (page && std::filesystem::path(arguments.report.text).extension() != ".html")
    refuse(fmt::format("--report {}: its name must end in .html", arguments.report.text));
}

/// Refuses options about a motion, if there is no motion.
void check_motion_usage(const StanceArguments& arguments) {
  if (arguments.lift && arguments.drop) refuse("--drop: not with --lift, which begins elsewhere");
  if (arguments.simulate) return;
  if (arguments.lift) refuse("--lift: give --simulate, too");
  if (arguments.drop) refuse("--drop: give --simulate, too");
  if (arguments.push) refuse("--push: give --simulate, too");
  if (!arguments.csv.empty()) refuse("--csv: give --simulate, too");
  if (!arguments.plot.empty()) refuse("--plot: give --simulate, too");
}

/// Checks everything that the options alone determine, before any file is opened.
void check_usage(const StanceArguments& arguments) {
  if (!arguments.joints.empty() && !arguments.accelerations.given) refuse("--joint: give --accelerations, too");
  if (arguments.cells && !arguments.accelerations.given && !arguments.equilibrium && !arguments.stability)
    refuse("--cells: give --accelerations, --equilibrium or --stability, too");
  if (arguments.drop_height && !arguments.bounce) refuse("--drop-height: give --bounce, too");
  check_motion_usage(arguments);
  if (!arguments.parameter_map.empty() && arguments.equilibrium.has_value() == arguments.stability.has_value())
    refuse("--parameter-map: give either --equilibrium or --stability, too");
  if (!arguments.certificate_file.empty() && !arguments.equilibrium)
    refuse("--certificate-file: is of the equilibrium: give --equilibrium, too");
  check_report_usage(arguments);
}

/// Checks the files before all the work, not after it. Throws Error(input) if a file would overwrite another,
/// Error(failure) if it cannot be written.
void check_outputs(const StanceArguments& arguments) {
  std::vector<std::string> others{arguments.model};
  const auto check = [&](std::string_view option, const std::string& file) {
    if (file.empty()) return;
    refuse_to_overwrite(option, file, others);
    if (std::ranges::find(others, file) != others.end())
      refuse(fmt::format("{} {}: the same file twice", option, file));
    others.push_back(file);
    const OutputFile trial(file);  // leaves nothing behind
  };
  check("--parameter-map", arguments.parameter_map);
  check("--csv", arguments.csv);
  check("--plot", arguments.plot);
  check("--report", arguments.report.text);
  check("--certificate-file", arguments.certificate_file);
  check_certificate_file(arguments.certificate_file, {arguments.model});
}

/// The words between commas.
std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<std::uint32_t> parse_uncertain(const std::string& list, const stance::Model& model) {
  if (list == "none") return {};
  return list == "all" ? uncertain_parameters(model) : uncertain_parameters(model, split(list));
}

AccelerationCase parse_case(const std::string& text) {
  constexpr AccelerationCase by_default = AccelerationCase::fall;
  if (text.empty()) return by_default;
  const auto parse = choice<AccelerationCase>({{"fall", AccelerationCase::fall},
                                               {"contact", AccelerationCase::contact},
                                               {"standing", AccelerationCase::standing}});
  return parse("--accelerations", text);
}

Push parse_push(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "FORCE,START,DURATION");
  if (numbers[1] < 0.0) refuse(fmt::format("{}: in {} the start is before 0", option, text));
  if (!(numbers[2] > 0.0)) refuse(fmt::format("{}: in {} the duration is not above 0", option, text));
  return {numbers[0], numbers[1], numbers[2]};
}

void write_file(const std::string& name, const std::string& text) {
  if (name.empty()) return;
  OutputFile file{name};
  file.write(text);
  file.finish();
}

[[noreturn]] void report_escape(const stance::Model& model, const std::string& component, const Enclosure& claimed,
                                const Escape& escape) {
  std::vector<std::string> sample;
  for (std::size_t i = 0; i < escape.parameters.size(); ++i) {
    sample.push_back(fmt::format("{} = {}", model.parameters[i].name, escape.parameters[i]));
  }
  throw Error(ErrorKind::failure,
              fmt::format("{}: the sample {} gives [{}, {}], which escapes from the enclosure [{}, {}]", component,
                          fmt::join(sample, ", "), escape.exact.lo, escape.exact.hi, claimed.lo, claimed.hi));
}

/// One run of the command, whose parts fill the summary.
class Analysis {
 public:
  explicit Analysis(const StanceArguments& arguments) : arguments_(arguments) {
    summary_.file = arguments.model;
    summary_.mode = arguments.mode.value_or(Mode::tight);
    summary_.acceleration_case = parse_case(arguments.accelerations.text);
    summary_.model = stance::read_model(arguments.model);
    for (const NamedRange& range : arguments.ranges) {
      const std::uint32_t parameter = parameter_named(summary_.model, range.name, "--range: {} is not one of {}");
      summary_.model = narrowed(std::move(summary_.model), parameter, range.range);
    }
    summary_.uncertain = parse_uncertain(arguments.uncertain.value_or("all"), summary_.model);
    if (arguments.within)
      summary_.model = narrowed_within(std::move(summary_.model), summary_.uncertain, *arguments.within);
    for (const NamedNumber& joint : arguments.joints)
      summary_.elsewhere.push_back(joint_position(summary_.model, joint.name, joint.number));
    if (!arguments.certificate_file.empty()) refuse_moved_numbers(arguments.ranges);
    if (!arguments.parameter_map.empty() && summary_.uncertain.size() != 2) {
      refuse(fmt::format("--parameter-map: is of two uncertain parameters, not of {}: name them by --uncertain",
                         summary_.uncertain.size()));
    }
    if (!arguments.bounce) return;
    const ContactCylinder& cylinder = cylinder_of(summary_.model, *arguments.bounce);
    summary_.dropped = cylinder.name;
    summary_.bounce_scope = bounce_scope(summary_.model, cylinder);
    summary_.drop =
        drop_of(summary_.model, cylinder, summary_.uncertain, arguments.drop_height.value_or(default_drop_height));
  }

  [[nodiscard]] const StanceSummary& run() {
    const Stopwatch time;
    if (arguments_.report.given && arguments_.report.text.empty()) {
      compare();
    } else {
      enclose_wrench();
      if (arguments_.accelerations.given) enclose_accelerations();
      if (arguments_.equilibrium) enclose_equilibrium();
      if (!arguments_.certificate_file.empty())
        certify_equilibrium(arguments_.certificate_file, summary_, arguments_.no_progress);
      if (arguments_.stability) decide_stability();
      if (!arguments_.parameter_map.empty()) draw_parameter_map();
      if (arguments_.simulate) enclose_motion();
      if (summary_.drop) summary_.bounce = bounce(*summary_.drop, {.interrupted = interrupted});
    }
    summary_.seconds = time.seconds();
    summary_.interrupted = interrupted();
    if (!arguments_.report.text.empty()) write_stance_page(arguments_.report.text, summary_);
    return summary_;
  }

 private:
  /// A certificate is about the file's model, which states the nominal values.
  void refuse_moved_numbers(const std::vector<NamedRange>& ranges) const {
    for (const NamedRange& range : ranges) {
      const auto is_named = [&](std::uint32_t k) { return summary_.model.parameters[k].name == range.name; };
      if (std::ranges::none_of(summary_.uncertain, is_named))
        refuse(fmt::format("--certificate-file: {} has a --range, but is not --uncertain", range.name));
    }
  }

  void compare() {
    try {
      summary_.paper = compare_with_paper(summary_.model);
    } catch (const Error& error) {
      throw Error(error.kind(), fmt::format("--report: {}: {}", arguments_.model, error.what()));
    }
  }

  /// The sensitivities determine which parameters have no effect, whether or not they are requested. Nothing once
  /// interrupted: readers take a parameter that is not listed for one without effect.
  void enclose_wrench() {
    std::vector<WrenchEnclosure> sensitivities;
    for (std::uint32_t i = 0; i < summary_.model.parameters.size(); ++i) {
      if (interrupted()) return;
      sensitivities.push_back(sensitivity(summary_.model, summary_.uncertain, i, summary_.mode));
    }
    const WrenchEnclosure enclosures = wrench(summary_.model, summary_.uncertain, summary_.mode);
    summary_.wrench = enclosures;
    summary_.wrench_scope = wrench_scope(summary_.model, sensitivities);
    std::vector<std::string> names;
    for (std::size_t k = 0; k < wrench_size; ++k) names.push_back(component_name(k));
    summary_.wrench_samples = check(sampled_wrench_of(summary_.model, {enclosures.begin(), enclosures.end()}), names);
    if (!arguments_.sensitivities) return;
    std::vector<WrenchEnclosure> of_uncertain;
    for (const std::uint32_t k : summary_.uncertain) of_uncertain.push_back(sensitivities[k]);
    summary_.reference = reference_uncertainty(summary_.model, summary_.uncertain, of_uncertain);
    summary_.sensitivities = std::move(sensitivities);
  }

  [[nodiscard]] AccelerationOptions acceleration_options() const {
    AccelerationOptions options;
    if (arguments_.cells) options.cells = *arguments_.cells;
    options.interrupted = interrupted;
    return options;
  }

  void enclose_accelerations() {
    summary_.acceleration_scope = acceleration_scope(summary_.model, summary_.acceleration_case);
    const Instant at = instant(summary_.model, summary_.acceleration_case, summary_.elsewhere);
    {
      ProgressBar bar(!arguments_.no_progress, "%");
      std::mutex mutex;
      AccelerationOptions options = acceleration_options();
      options.progress = [&](double fraction) {
        const std::lock_guard lock(mutex);
        bar.update(static_cast<std::uint64_t>(100.0 * fraction), fraction);
      };
      summary_.accelerations = accelerations(summary_.model, summary_.uncertain, at, options);
    }
    summary_.acceleration_samples =
        check(sampled_accelerations_of(summary_.model, at, summary_.accelerations), joint_names(summary_.model));
  }

  /// The options of equilibria, and of their stability, which have the same. The bar must outlive them.
  [[nodiscard]] EquilibriumOptions options_by_cells(JointControl control, ProgressBar& bar) const {
    EquilibriumOptions options{.control = control, .interrupted = interrupted};
    if (arguments_.cells) options.cells = *arguments_.cells;
    options.progress = [&bar](double fraction) { bar.update(static_cast<std::uint64_t>(100.0 * fraction), fraction); };
    return options;
  }

  void enclose_equilibrium() {
    summary_.control = *arguments_.equilibrium;
    summary_.equilibrium_scope = equilibrium_scope(summary_.model, summary_.control);
    ProgressBar bar(!arguments_.no_progress, "%");
    summary_.equilibrium = equilibrium(summary_.model, summary_.uncertain, options_by_cells(summary_.control, bar));
  }

  void draw_parameter_map() const {
    const Parameter& across = summary_.model.parameters[summary_.uncertain[0]];
    const Parameter& upward = summary_.model.parameters[summary_.uncertain[1]];
    write_file(arguments_.parameter_map, summary_.equilibrium
                                             ? parameter_map(summary_.equilibrium->cells, {across, upward})
                                             : parameter_map(summary_.stability->cells, {across, upward}));
  }

  void decide_stability() {
    summary_.stability_control = *arguments_.stability;
    summary_.stability_scope = stability_scope(summary_.model, summary_.stability_control);
    ProgressBar bar(!arguments_.no_progress, "%");
    summary_.stability =
        stability(summary_.model, summary_.uncertain, options_by_cells(summary_.stability_control, bar));
  }

  void enclose_motion() {
    ProgressBar bar(!arguments_.no_progress, "%");
    MotionOptions options{
        .duration = *arguments_.simulate, .lift = arguments_.lift.value_or(0.0), .drop = arguments_.drop};
    options.push = arguments_.push;
    summary_.motion_scope = motion_scope(summary_.model, options);
    options.interrupted = interrupted;
    options.progress = [&](double fraction) { bar.update(static_cast<std::uint64_t>(100.0 * fraction), fraction); };
    summary_.motion_duration = options.duration;
    summary_.motion = simulate(summary_.model, summary_.uncertain, options);
    write_file(arguments_.csv, motion_table(*summary_.motion));
    write_file(arguments_.plot, motion_picture(*summary_.motion));
  }

  /// Nothing unless --monte-carlo requests it.
  [[nodiscard]] std::optional<Samples> check(const Sampled& sampled, const std::vector<std::string>& names) const {
    if (!arguments_.monte_carlo) return std::nullopt;
    ProgressBar bar(!arguments_.no_progress, "samples");
    const auto count = static_cast<double>(*arguments_.monte_carlo);
    Samples samples = take_samples(
        summary_.model, summary_.uncertain, sampled,
        {.count = *arguments_.monte_carlo, .interrupted = interrupted, .progress = [&](std::uint64_t done) {
           bar.update(done, static_cast<double>(done) / count);
         }});
    if (const auto& escape = samples.escape) {
      report_escape(summary_.model, names[escape->component], sampled.claimed[escape->component], *escape);
    }
    return samples;
  }

  const StanceArguments& arguments_;
  StanceSummary summary_;
};

bool is_finite(const Enclosure& enclosure) {
  return std::isfinite(enclosure.lo) && std::isfinite(enclosure.hi);
}

bool is_proven(const Bounce& bounce) {
  return bounce.proven &&
         std::ranges::all_of(std::array{bounce.touch_down_time, bounce.touch_down_speed, bounce.deepest_penetration,
                                        bounce.lift_off_time, bounce.rebound_speed, bounce.effective_restitution},
                             is_finite);
}

bool all_proven(const StanceSummary& summary) {
  const auto finite = [](const auto& enclosures) { return std::ranges::all_of(enclosures, is_finite); };
  return (!summary.paper || summary.paper->all_explained()) && (!summary.wrench || finite(*summary.wrench)) &&
         std::ranges::all_of(summary.sensitivities, finite) && finite(summary.accelerations) &&
         (!summary.equilibrium || summary.equilibrium->stands == 1.0) &&
         (!summary.certified || summary.certified->stands == 1.0) &&
         (!summary.stability || summary.stability->stable == 1.0) && (!summary.motion || summary.motion->proven) &&
         (!summary.bounce || is_proven(*summary.bounce));
}

void declare_simulation(Options& options, StanceArguments& arguments) {
  options.add("--simulate", arguments.simulate, parse_positive_length, "SECONDS",
              "Also how the body moves in its sagittal plane, from its nominal equilibrium on, for so long");
  options.add(
      "--drop", arguments.drop, parse_length, "NUMBER",
      "With --simulate: let it go in the file's posture instead, its lowest sole so far above the ground, in m");
  options.add("--lift", arguments.lift, parse_length, "NUMBER",
              "With --simulate: let it go so far above the equilibrium, in m");
  options.add(
      "--push", arguments.push, parse_push, "FORCE,START,DURATION",
      "With --simulate: a force along x (N, s, s) on the reference point, FORCE sin^2(pi (t - START)/DURATION)");
  options.add("--csv", arguments.csv, "FILE", "With --simulate: enclosures over time, as a table");
  options.add("--plot", arguments.plot, "FILE", "With --simulate: the enclosures over time as a picture (SVG)");
}

}  // namespace

void declare_stance(Options& options, StanceArguments& arguments) {
  options.explain(closing_words);
  options.require("model", arguments.model, "MODEL.xml", "Stance model (XML)");
  options.add("--uncertain", arguments.uncertain, "NAMES",
              "Parameters that take their whole range: names between commas, all (default) or none");
  options.add("--mode", arguments.mode, choice<Mode>({{"paper", Mode::paper}, {"tight", Mode::tight}}), "MODE",
              "tight (default), or paper: with the paper's expression of w6, in which px occurs three times");
  options.add_flag("--sensitivities", arguments.sensitivities,
                   "Also the wrench's derivatives by every parameter, and the reference uncertainty");
  options.add_flag_or_text("--accelerations", arguments.accelerations, "CASE",
                           "Also the accelerations of all joints: in free fall (fall, default); let go at rest in the\n"
                           "file's posture, where the ground presses on the cylinders that touch it (contact); or at\n"
                           "the nominal body's equilibrium, held by its torques (standing)");
  options.add_each("--joint", arguments.joints, parse_named_number, "NAME=NUMBER",
                   "With --accelerations: this joint elsewhere than in the file, in m or rad, such as\n"
                   "'pelvis ty=0.98'; may be repeated. In contact its controller's proportional part acts");
  options.add("--equilibrium", arguments.equilibrium,
              choice<JointControl>({{"held", JointControl::held}, {"proportional", JointControl::proportional}}),
              "JOINTS",
              "Also where the body is in equilibrium on its cylinders, stable or not: with its joints held where the\n"
              "file has them, or turned from there as the proportional gains alone allow");
  options.add("--stability", arguments.stability,
              choice<JointControl>({{"held", JointControl::held}, {"proportional", JointControl::proportional}}),
              "JOINTS",
              "Also whether small disturbances of that equilibrium die out: with the whole controllers acting (held),\n"
              "or without their integral parts (proportional)");
  options.add("--parameter-map", arguments.parameter_map, "FILE",
              "With --equilibrium or --stability and two uncertain parameters: their cells as a picture (SVG)");
  options.add("--certificate-file", arguments.certificate_file, "FILE",
              "With --equilibrium: its cells and what proves them again, for `verisq check --certificate`: .json");
  declare_simulation(options, arguments);
  options.add_each("--range", arguments.ranges, parse_named_range, "NAME=LO,HI",
                   "A part of a parameter's range instead of the file's; may be repeated");
  options.add("--within", arguments.within, parse_positive_length, "PERCENT",
              "Uncertain parameters are at most this part of their nominal value off it");
  options.add("--cells", arguments.cells, whole_number(1U, most_cells), "NUMBER",
              "Finest division of each uncertain parameter's range: of --accelerations (default 64), which divides\n"
              "only where a component may be largest or smallest; of --equilibrium and --stability (default 16)");
  options.add("--monte-carlo", arguments.monte_carlo, whole_number<std::uint64_t>(1), "COUNT",
              "Sample the uncertain parameters, check that the enclosures contain all samples, and say how much\n"
              "of them the samples fill");
  options.add_flag_or_text("--report", arguments.report, "FILE",
                           "With --equilibrium, --stability or --simulate: a page of them that any browser shows,\n"
                           "without a network: .html. Without a file, instead: Tables 2, 3 and 4 of the paper, cell\n"
                           "by cell, with the constants that were reconstructed from these same tables");
  options.add("--bounce", arguments.bounce, "CYLINDER",
              "Also drop this contact cylinder alone, with the mass of its body, and enclose its rebound; the mass,\n"
              "the normal restitution and the impact velocity take their ranges where they are uncertain");
  options.add("--drop-height", arguments.drop_height, parse_positive_length, "NUMBER",
              "Of its lowest point, in m (default 0.01)");
  options.add_flag("--json", arguments.json, "Print one JSON object");
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_stance(const StanceArguments& arguments) {
  check_usage(arguments);
  check_outputs(arguments);
  watch_for_interruption();
  Analysis analysis(arguments);
  const StanceSummary& summary = analysis.run();
  fmt::print("{}", arguments.json ? json(summary) : readable(summary));
  if (summary.interrupted) return ExitStatus::interrupted;
  return all_proven(summary) ? ExitStatus::verified : ExitStatus::unverified;
}

Command stance_command() {
  return command("stance",
                 "Enclose wrench, sensitivities and accelerations of a stance model with uncertain parameters",
                 declare_stance, run_stance);
}

}  // namespace verisq::command_line
