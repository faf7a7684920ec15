// SPDX-License-Identifier: Apache-2.0
#include "gnuplot.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

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

std::string title_command(std::string_view title, std::string_view options) {
  return fmt::format("set title {} noenhanced {}\n",
                     gnuplot_quoted(fmt::format("{}  (research use only)", title)), options);
}

Gnuplot::Gnuplot(std::string directory) : directory_(std::move(directory)) {
  if (std::any_of(directory_.begin(), directory_.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
    throw InputError(directory_, "has a control character in its name", "name another folder");
  }
  // An interrupt is the command's to handle; the user's own gnuplot settings are left out.
  pipe_ = popen("trap '' INT; LC_ALL=C.UTF-8 exec gnuplot -d >/dev/null", "w");
  if (pipe_ == nullptr) fail(std::strerror(errno));
  send("set encoding utf8\nset grid back lt 1 lw 0.5 lc rgb '#d0d0d0'\n");
}

Gnuplot::~Gnuplot() {
  if (pipe_ != nullptr) pclose(pipe_);
}

void Gnuplot::send(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), pipe_);
}

void Gnuplot::draw(const std::string& name, const std::string& plot, int width, int height) {
  const std::pair<const char*, std::string> terminals[] = {
      {".svg", fmt::format("svg size {},{} dynamic", width, height)},
      {".png", fmt::format("pngcairo size {},{}", width * 3 / 2, height * 3 / 2)}};
  for (const auto& [ending, terminal] : terminals) {
    const auto path = std::filesystem::path(directory_) / (name + ending);
    files_.push_back(std::make_unique<OutputFile>(path.string()));
    send(fmt::format("set terminal {} background 'white'\nset output {}\n{}\nunset output\n",
                     terminal, gnuplot_quoted(files_.back()->path_while_writing()), plot));
  }
}

std::vector<std::unique_ptr<OutputFile>> Gnuplot::finish() {
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) fail("it is not installed");
  if (status != 0) fail("it failed; its own words stand above");
  for (const auto& file : files_) file->close();
  return std::move(files_);
}

}  // namespace condyle::host
