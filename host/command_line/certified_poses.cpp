/// One search for all threads, a chunk of poses at a time.
#include "host/command_line/certified_poses.hpp"

#include <cstddef>
#include <utility>
#include <vector>
#include <verisq/certified_distance.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/pose_stream.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {

std::vector<PosedAnswer> certified_distances(const Model& a, const Model& b, const std::string& poses, double tolerance,
                                             bool show_progress) {
  constexpr std::size_t chunk_size = 4096;
  const CertifiedDistances distances(a, b, tolerance);
  PoseStream stream(poses);
  ProgressBar bar(show_progress, "certificates");
  std::vector<PosedAnswer> answers;
  std::vector<Pose> chunk(chunk_size);
  while (const std::size_t count = stream.read(chunk)) {
    const std::size_t first = answers.size();
    answers.resize(first + count);
    in_parallel(count, [&](std::size_t i) {
      auto [distance, certificate] = distances(chunk[i], interrupted);
      answers[first + i] = {chunk[i], distance, std::move(certificate)};
    });
    bar.update(answers.size(), stream.fraction(answers.size()));
    if (interrupted()) break;
  }
  return answers;
}

}  // namespace verisq::command_line
