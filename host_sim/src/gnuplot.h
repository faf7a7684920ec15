// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace condyle::host {

/// A text as gnuplot reads it, in quotation marks.
std::string gnuplot_quoted(std::string_view text);

/// A running gnuplot. Problems are InputErrors.
class Gnuplot {
 public:
  Gnuplot();
  ~Gnuplot();
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  /// Gives it commands.
  void send(const std::string& text);
  /// Waits until it has drawn everything.
  void finish();

 private:
  std::FILE* pipe_;
};

}  // namespace condyle::host
