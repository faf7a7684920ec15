// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "output/output_file.h"

namespace condyle::host {

/// A text quoted for gnuplot.
std::string gnuplot_quoted(std::string_view text);

/// The command that gives a figure its title, which includes "research use only"; `options`: those
/// of gnuplot.
std::string title_command(std::string_view title, std::string_view options = "");

/// Why condyle starts no gnuplot on this system, and what draws instead; empty if it starts one.
std::string why_no_figures();

/// A running gnuplot that draws into a folder. If it is missing or fails there is no figure, and
/// the command reports it at the end (deferred_problem.h).
class Gnuplot {
 public:
  /// `directory` must exist.
  explicit Gnuplot(std::string directory);
  ~Gnuplot();
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  /// Sends commands.
  void send(const std::string& text);
  /// Draws `plot` to NAME.svg and to NAME.png, 1.5 times as large.
  void draw(const std::string& name, const std::string& plot, int width, int height);
  /// Waits until everything is drawn. The files are closed but not committed.
  std::vector<std::unique_ptr<OutputFile>> finish();

 private:
  int wait();

  std::string directory_, problem_;
  pid_t child_ = 0;
  std::vector<std::unique_ptr<OutputFile>> files_;
  std::FILE* pipe_ = nullptr;
};

}  // namespace condyle::host
