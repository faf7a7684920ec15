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

/// A text as gnuplot reads it, in quotation marks.
std::string gnuplot_quoted(std::string_view text);

/// The command that gives a figure its title, which says "research use only"; `options` as
/// gnuplot's.
std::string title_command(std::string_view title, std::string_view options = "");

/// A running gnuplot that draws into a folder. Where it is missing or fails there is no figure, and
/// the command is told so at its end (deferred_problem.h).
class Gnuplot {
 public:
  /// `directory` must be there.
  explicit Gnuplot(std::string directory);
  ~Gnuplot();
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  /// Gives it commands.
  void send(const std::string& text);
  /// Draws what `plot` says to NAME.svg and NAME.png, half as large again.
  void draw(const std::string& name, const std::string& plot, int width, int height);
  /// Waits until it has drawn everything. The files are closed, and wait for `commit`.
  std::vector<std::unique_ptr<OutputFile>> finish();

 private:
  int wait();

  std::string directory_, problem_;
  pid_t child_ = 0;
  std::vector<std::unique_ptr<OutputFile>> files_;
  std::FILE* pipe_ = nullptr;
};

}  // namespace condyle::host
