// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "hosted/devices/source_spec.h"

namespace condyle::host {
namespace {

bool is_file(const std::string& path) {
  std::error_code missing;
  const auto status = std::filesystem::status(path, missing);
  return std::filesystem::exists(status) && !std::filesystem::is_directory(status);
}

// Length of the first file's name in `text`: the longest that exists, otherwise up to the first
// '+'.
std::size_t first_length(const std::string& text) {
  for (std::size_t end = text.size(); end != std::string::npos && end > 0;
       end = text.rfind('+', end - 1)) {
    if (is_file(text.substr(0, end))) return end;
  }
  return std::min(text.find('+'), text.size());
}

}  // namespace

std::vector<std::string> recording_files(const std::string& source) {
  const SourceSpec spec = source_of(source);
  if (spec.kind != SourceKind::file) return {spec.file};
  std::vector<std::string> files;
  std::string rest = spec.file;
  while (true) {
    const std::size_t length = first_length(rest);
    files.push_back(rest.substr(0, length));
    if (length == rest.size()) return files;
    rest.erase(0, length + 1);
  }
}

std::string recording_name(const std::string& source) {
  const std::vector<std::string> files = recording_files(source);
  if (files.size() == 1) return std::filesystem::path(source).filename().string();
  std::vector<std::string> names;
  for (const std::string& file : files) {
    names.push_back(std::filesystem::path(file).filename().string());
  }
  return fmt::format("{}", fmt::join(names, "+"));
}

}  // namespace condyle::host
