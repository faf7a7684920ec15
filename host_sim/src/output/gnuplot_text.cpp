// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "hosted/files/clean_text.h"
#include "output/gnuplot.h"

namespace condyle::host {

std::string gnuplot_quoted(std::string_view text) {
  std::string result = "'";
  // At the start of a text, gnuplot does not read two apostrophes as an escaped one.
  for (const char c : clean_line(text)) result += c == '\'' ? "\u2019" : std::string(1, c);
  return result + "'";
}

std::string title_command(std::string_view title, std::string_view options) {
  return fmt::format("set title {} noenhanced {}\n",
                     gnuplot_quoted(fmt::format("{}  (research use only)", title)), options);
}

}  // namespace condyle::host
