/// One search for all threads, a chunk of poses at a time.
#include "host/command_line/certified_poses.hpp"

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>
#include <verisq/model_distance.hpp>
#include <verisq/model_search.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/pose_stream.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

using Answering = std::function<PosedAnswer(const Pose&)>;

Answering by_certificates(const Model& a, const Model& b) {
  return [pair = std::make_shared<const PairDistance>(a, b)](const Pose& pose) {
    ModelDistance found = (*pair)(pose, interrupted);
    return PosedAnswer{pose, found.distance, std::move(found.certificate)};
  };
}

Answering by_search(const Model& a, const Model& b, const SearchOptions& options) {
  return [search = std::make_shared<const ModelSearch>(a, b), options](const Pose& pose) {
    auto [distance, certificate] = search->certified(pose, (*search)(pose, options), options);
    return PosedAnswer{pose, distance, std::move(certificate)};
  };
}

}  // namespace

std::vector<PosedAnswer> certified_distances(const Model& a, const Model& b, const std::string& poses, double tolerance,
                                             bool show_progress) {
  constexpr std::size_t chunk_size = 4096;
  const Answering answer = is_union_of_convex(a) && is_union_of_convex(b)
                               ? by_certificates(a, b)
                               : by_search(a, b, {.tolerance = tolerance, .interrupted = [] { return interrupted(); }});
  PoseStream stream(poses);
  ProgressBar bar(show_progress, "certificates");
  std::vector<PosedAnswer> answers;
  std::vector<Pose> chunk(chunk_size);
  while (const std::size_t count = stream.read(chunk)) {
    const std::size_t first = answers.size();
    answers.resize(first + count);
    in_parallel(count, [&](std::size_t i) { answers[first + i] = answer(chunk[i]); });
    bar.update(answers.size(), stream.fraction(answers.size()));
    if (interrupted()) break;
  }
  return answers;
}

}  // namespace verisq::command_line
