/// Progress a few times a second.
#include "host/fit/search_watch.hpp"

namespace verisq::fit_search {

namespace {

constexpr std::chrono::milliseconds kBetweenReports{200};

}  // namespace

bool SearchWatch::interrupted() {
  interrupted_ = interrupted_ || options_.interrupted();
  report_now_and_then();
  return interrupted_;
}

void SearchWatch::at(std::size_t implant, double share) {
  implant_ = implant;
  share_ = share;
  report_now_and_then();
}

void SearchWatch::report_now_and_then() {
  if (Clock::now() < next_report_) return;
  next_report_ = Clock::now() + kBetweenReports;
  const double done = (static_cast<double>(implant_) + share_) / static_cast<double>(implants_);
  options_.progress({.objective = best_, .done = done, .implant = implant_});
}

}  // namespace verisq::fit_search
