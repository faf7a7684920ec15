// SPDX-License-Identifier: Apache-2.0
#include "gnuplot.h"

#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "input_error.h"

namespace condyle::host {
namespace {

[[noreturn]] void fail(const std::string& problem) {
  throw InputError("gnuplot", "cannot draw the figures: " + problem,
                   "install it (Debian package gnuplot-nox) or leave out --figures");
}

}  // namespace

std::string gnuplot_quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + "'";
}

// An interrupt is the command's to handle; the user's own gnuplot settings are left out.
Gnuplot::Gnuplot() : pipe_(popen("trap '' INT; LC_ALL=C.UTF-8 exec gnuplot -d >/dev/null", "w")) {
  if (pipe_ == nullptr) fail(std::strerror(errno));
}

Gnuplot::~Gnuplot() {
  if (pipe_ != nullptr) pclose(pipe_);
}

void Gnuplot::send(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), pipe_);
}

void Gnuplot::finish() {
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) fail("it is not installed");
  if (status != 0) fail("it failed; its own words stand above");
}

}  // namespace condyle::host
