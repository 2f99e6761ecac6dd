// SPDX-License-Identifier: BSD-3-Clause
#include "check/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdarg>
#include <cstdio>

namespace ilaw::check {
namespace {

double clock_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// One write each, so that lines do not mix.
[[gnu::format(printf, 1, 2)]] void write_to_stderr(const char* format, ...) {
  std::array<char, 400> text{};
  va_list values;
  va_start(values, format);
  const int size = std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  [[maybe_unused]] const ssize_t written = write(
      STDERR_FILENO, text.data(), std::min(static_cast<std::size_t>(std::max(size, 0)), text.size() - 1));
}

std::string short_time(double seconds) {
  constexpr double minute = 60.0, hour = 3600.0;
  std::array<char, 32> text{};
  if (seconds < 2.0 * minute)
    std::snprintf(text.data(), text.size(), "%.0f s", seconds);
  else if (seconds < 2.0 * hour)
    std::snprintf(text.data(), text.size(), "%.0f min", seconds / minute);
  else
    std::snprintf(text.data(), text.size(), "%.1f h", seconds / hour);
  return text.data();
}

}  // namespace

void add_progress(CLI::App& command, ProgressForm& form) {
  command.add_flag_callback(
      "--json-lines", [&form] { form = ProgressForm::json_lines; },
      "Tell the progress on stderr as a JSON object per line, once a second, for machines");
}

Progress::Progress(std::string task, std::string unit, double total, ProgressForm form)
    : task_(std::move(task)),
      unit_(std::move(unit)),
      form_(form),
      is_shown_(form == ProgressForm::json_lines ||
                (form == ProgressForm::line && isatty(STDERR_FILENO) == 1)),
      start_(clock_now()),
      total_(total),
      next_(start_ + 0.1) {}  // short work shows nothing

Progress::~Progress() {
  if (!is_shown_) return;
  if (form_ == ProgressForm::json_lines) write_object(clock_now());
  if (is_drawn_) write_to_stderr("\r\033[K");
}

void Progress::add(double amount) {
  if (!is_shown_) return;
  done_ += amount;
  show_now_and_then();
}

void Progress::begin_at(double done) { done_ = first_ = done; }

void Progress::set(double done, double total) {
  if (!is_shown_) return;
  done_ = done;
  total_ = total;
  show_now_and_then();
}

void Progress::show_now_and_then() {
  const double now = clock_now(), between = form_ == ProgressForm::line ? 0.1 : 1.0;
  double next = next_;
  if (now < next || !next_.compare_exchange_strong(next, now + between)) return;
  if (form_ == ProgressForm::json_lines) return write_object(now);
  is_drawn_ = true;
  draw_line(now);
}

double Progress::part() const { return std::clamp(done_ / total_, 0.0, 1.0); }

double Progress::rate(double now) const { return (done_ - first_) / std::max(now - start_, 1e-9); }

void Progress::write_object(double now) const {
  const double speed = rate(now), left = std::max(total_ - done_, 0.0);
  write_to_stderr(
      "{\"task\": \"%s\", \"unit\": \"%s\", \"done\": %.10g, \"total\": %.10g, \"percent\": %.1f, "
      "\"per_second\": %.4g, \"seconds\": %.3f, \"seconds_left\": %.3g}\n",
      task_.c_str(), unit_.c_str(), done_.load(), total_.load(), 100.0 * part(), speed, now - start_,
      speed > 0.0 ? left / speed : 0.0);
}

void Progress::draw_line(double now) const {
  constexpr std::size_t width = 30;
  const auto filled = static_cast<std::size_t>(part() * static_cast<double>(width));
  const double speed = rate(now), left = std::max(total_ - done_, 0.0);
  write_to_stderr(speed < 1e3 ? "\r\033[K%s [%s%s] %3.0f %%  %.3g %s/s  %s left "
                              : "\r\033[K%s [%s%s] %3.0f %%  %.0f %s/s  %s left ",
                  task_.c_str(), std::string(filled, '#').c_str(), std::string(width - filled, '.').c_str(),
                  100.0 * part(), speed, unit_.c_str(), speed > 0.0 ? short_time(left / speed).c_str() : "?");
}

}  // namespace ilaw::check
