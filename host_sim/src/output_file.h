// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace condyle::host {

/// A file that appears under its name only when it is complete: written beside it and renamed by
/// `commit`; without that, nothing is left. A pipe or device that exists is written directly.
/// Problems are InputErrors.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  /// Writes out what is buffered and gives the file its name.
  void commit();
  /// Where the file is being written.
  const std::string& path_while_writing() const { return temporary_path_; }

 private:
  [[noreturn]] void fail(const char* what) const;

  std::string path_;
  std::string temporary_path_;
  std::FILE* file_ = nullptr;
};

}  // namespace condyle::host
