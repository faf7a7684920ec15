// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// A file that appears under its name only when it is complete: written beside it, `close`d, then
/// renamed by `commit`; without that, nothing is left. A pipe or device that exists is written
/// directly, and so is the standard output, which is named "-". Problems are InputErrors.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// True once a file was named "-".
  static bool has_standard_output() { return has_standard_output_; }

  void write(std::string_view text);
  /// Writes out what is buffered. Whatever the disk has against it is said here.
  void close();
  /// Gives the closed file its name.
  void commit();
  /// Name that `commit` gives it.
  const std::string& path() const { return path_; }
  /// Where the file is being written.
  const std::string& path_while_writing() const { return temporary_path_; }

 private:
  [[noreturn]] void fail(const char* what) const;

  static inline bool has_standard_output_ = false;

  std::string path_;
  std::string temporary_path_;
  std::FILE* file_ = nullptr;
};

/// Gives all of the closed `files` their names; returns these, a line each.
std::string commit_all(const std::vector<std::unique_ptr<OutputFile>>& files);

/// Throws InputError if one of `outputs` is one of `inputs` or named twice. Empty names are
/// left out.
void refuse_same_files(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs);

/// A folder, made where it is missing. What was made goes again if it stays empty.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::filesystem::path path_, first_made_;  // the outermost folder that was missing; may be empty
};

}  // namespace condyle::host
