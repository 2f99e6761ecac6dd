// progress.hpp - how far a long command is: one line on a terminal, or lines of JSON for machines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <atomic>
#include <string>

namespace ilaw::check {

// line: redrawn in place if stderr is a terminal, otherwise nothing. json_lines: an object per second.
enum class ProgressForm { none, line, json_lines };

// Adds --json-lines to a command.
void add_progress(CLI::App& command, ProgressForm& form);

// Counts work against its total, and shows on stderr the percentage, the rate and the time left. Threads may
// count in it at the same time.
class Progress {
 public:
  Progress(std::string task, std::string unit, double total, ProgressForm form);
  ~Progress();  // wipes the line, or writes the last object
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void add(double amount);
  void begin_at(double done);           // work of an earlier command, which says nothing about the rate
  void set(double done, double total);  // if the total is an estimate that changes

 private:
  void show_now_and_then();
  void write_object(double now) const;
  void draw_line(double now) const;
  double part() const;
  double rate(double now) const;

  std::string task_, unit_;
  ProgressForm form_;
  bool is_shown_;
  double start_, first_ = 0.0;
  std::atomic<double> done_{0.0}, total_, next_;
  std::atomic<bool> is_drawn_{false};
};

}  // namespace ilaw::check
