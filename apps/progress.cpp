#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <string_view>
#include <utility>
#include <vector>

#include "base/terminal.h"
#include "base/text_table.h"

namespace axisfit {
namespace {

constexpr std::string_view kClear = "\r\033[K";

std::atomic<bool> line_is_shown = false;
static_assert(decltype(line_is_shown)::is_always_lock_free);

/// All of it in one piece, whatever else is written. A terminal that is gone is no loss.
void put(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

void clear_line() {
  if (line_is_shown.exchange(false)) put(kClear);
}

std::string bar(int done, int of) {
  constexpr int kParts = 10;
  const auto full = static_cast<std::size_t>(std::clamp(done * kParts / of, 0, kParts));
  return "[" + std::string(full, '#') + std::string(kParts - full, '.') + "]";
}

}  // namespace

std::optional<double> time_left(int done, int of, double elapsed) {
  if (done < 2 || done >= of) return std::nullopt;
  return elapsed * (of - done) / done;
}

std::string about(double seconds) {
  for (const int step : {5, 10, 15, 20, 30, 40, 50})
    if (seconds < 1.1 * step) return fmt::format("about {} s", step);
  const double minutes = seconds / 60.0;
  if (minutes < 10.0) return fmt::format("about {:.0f} min", std::max(1.0, minutes));
  if (minutes < 117.5) return fmt::format("about {:.0f} min", 5.0 * std::round(minutes / 5.0));
  return fmt::format("about {:.0f} h", minutes / 60.0);
}

std::string stopwatch(double seconds) {
  const auto s = static_cast<long>(seconds);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string progress_text(const Progress& progress, double elapsed, std::optional<double> left,
                          std::size_t width) {
  enum Part { kPhase, kBar, kDone, kLeft, kBest, kElapsed };
  std::vector<std::string> parts(kElapsed + 1);
  parts[kPhase] = progress.phase;
  if (progress.of > 0) {
    parts[kBar] = bar(progress.done, progress.of);
    parts[kDone] = fmt::format("{} of {} done", progress.done, progress.of);
  }
  if (left) parts[kLeft] = about(*left) + " left";
  if (std::isfinite(progress.best)) parts[kBest] = fmt::format("red. chi2 {:.4g}", progress.best);
  parts[kElapsed] = stopwatch(elapsed);

  const auto joined = [&] {
    std::string text;
    for (const std::string& part : parts)
      if (!part.empty()) text += (text.empty() ? "" : "  ") + part;
    return text;
  };
  // In the last column some terminals begin a new line.
  const std::size_t room = width > 1 ? width - 1 : 0;
  for (const Part least : {kBar, kBest, kLeft, kDone, kElapsed}) {
    if (width_of(joined()) <= room) break;
    parts[least].clear();
  }
  return joined().substr(0, room);
}

ProgressLine::ProgressLine(bool visible) {
  if (visible) painter_ = std::jthread([this](const std::stop_token& end) { run(end); });
}

ProgressLine::~ProgressLine() {
  painter_ = {};  // asks it to end, and waits
  clear_line();
}

void ProgressLine::update(Progress progress) {
  const std::lock_guard lock(mutex_);
  if (!progress.finished.empty()) finished_ += progress.finished + "\n";
  // A count that goes on is that of the same phase, whatever it deals with at the moment.
  if (progress.of != progress_.of || progress.done < progress_.done) phase_begin_ = Clock::now();
  progress_ = std::move(progress);
}

void ProgressLine::run(const std::stop_token& end) {
  std::string painted;
  for (std::unique_lock lock(mutex_);;) {
    tick_.wait_for(lock, end, std::chrono::milliseconds(100), [] { return false; });
    if (end.stop_requested()) return;
    std::string text = text_now();
    const std::string stays = text.empty() ? "" : std::exchange(finished_, "");
    if (text == painted && stays.empty()) continue;
    lock.unlock();  // a terminal that is held does not hold the work
    line_is_shown = true;
    put(fmt::format("{}{}{}", kClear, stays, text));
    painted = std::move(text);
    lock.lock();
  }
}

std::string ProgressLine::text_now() const {
  const auto seconds_since = [now = Clock::now()](Clock::time_point begin) {
    return std::chrono::duration<double>(now - begin).count();
  };
  const double elapsed = seconds_since(begin_);
  if (elapsed < 1.0 || progress_.phase.empty()) return "";
  return progress_text(progress_, elapsed,
                       time_left(progress_.done, progress_.of, seconds_since(phase_begin_)),
                       terminal_width(STDERR_FILENO));
}

void end_by_signal(int signal) {
  clear_line();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace axisfit
