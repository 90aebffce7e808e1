/// This file implements the turns of pipes, and how large a chunk each takes.
#include "host/batches/several_pipes.hpp"

#include <algorithm>
#include <deque>
#include <exception>
#include <utility>

#include "host/batches/rows_side_by_side.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

// One of the pipes, and how fast it was.
struct Member {
  std::unique_ptr<PointPipe> pipe;
  double points_a_second = 0.0;  // of its last chunks; 0: not known yet
};

class SeveralPipes final : public PointPipe {
 public:
  explicit SeveralPipes(std::vector<std::unique_ptr<PointPipe>> pipes) {
    for (auto& pipe : pipes) members_.push_back({std::move(pipe)});
  }

  [[nodiscard]] std::size_t largest_chunk() const override {
    std::size_t largest = 0;
    for (const Member& member : members_) largest = std::max(largest, member.pipe->largest_chunk());
    return largest;
  }

  // So that all take about as long for theirs: rows come back in order, and the fast ones would wait for the slow.
  [[nodiscard]] std::size_t capacity() const override {
    const Member& next = members_[next_];
    const auto slower = [](const Member& a, const Member& b) { return a.points_a_second < b.points_a_second; };
    const double fastest = std::ranges::max_element(members_, slower)->points_a_second;
    const std::size_t all = next.pipe->capacity();
    if (next.points_a_second == 0.0) return all;
    const auto share = static_cast<std::size_t>(static_cast<double>(all) * next.points_a_second / fastest);
    return std::max(share - share % rows_side_by_side, rows_side_by_side);
  }

  [[nodiscard]] std::size_t depth() const override {
    std::size_t sum = 0;
    for (const Member& member : members_) sum += member.pipe->depth();
    return sum;
  }

  void submit(const PointColumns& points, const ResultColumns& rows) override {
    in_flight_.push_back({next_, points.size()});  // first: what begins before a failure must end, too
    next_ = (next_ + 1) % members_.size();
    members_[in_flight_.back().member].pipe->submit(points, rows);
  }

  ChunkOutcome collect() override {
    const Flight oldest = in_flight_.front();
    in_flight_.pop_front();
    Member& member = members_[oldest.member];
    const double before = member.pipe->device_seconds();
    const ChunkOutcome outcome = member.pipe->collect();
    const double seconds = member.pipe->device_seconds() - before;
    if (seconds > 0.0) member.points_a_second = static_cast<double>(oldest.points) / seconds;
    return outcome;
  }

  void discard() override {
    in_flight_.clear();
    std::exception_ptr failure;
    for (const Member& member : members_) {
      try {
        member.pipe->discard();
      } catch (const Error&) {
        failure = std::current_exception();  // the others must end, too
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

  // Of the one that took longest.
  [[nodiscard]] double device_seconds() const override {
    double longest = 0.0;
    for (const Member& member : members_) longest = std::max(longest, member.pipe->device_seconds());
    return longest;
  }

 private:
  struct Flight {
    std::size_t member, points;
  };

  std::vector<Member> members_;
  std::deque<Flight> in_flight_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<PointPipe> several_pipes(std::vector<std::unique_ptr<PointPipe>> pipes) {
  if (pipes.size() == 1) return std::move(pipes.front());
  return std::make_unique<SeveralPipes>(std::move(pipes));
}

}  // namespace verisq::device
