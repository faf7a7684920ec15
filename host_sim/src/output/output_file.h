// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// A file that appears under its name only when it is complete: it is written under a temporary
/// name, `close`d, then renamed by `commit`; without `commit` no file remains. An existing pipe or
/// device is written directly, as is the standard output, which is named "-". Problems are
/// InputErrors.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// True if a file was named "-".
  static bool has_standard_output() { return has_standard_output_; }

  void write(std::string_view text);
  /// Writes the buffer. Throws any error of the disk.
  void close();
  /// Renames the closed file to its final name.
  void commit();
  /// True for a pipe, a terminal or a device: someone reads it meanwhile, or stalls.
  bool has_reader() const { return has_reader_; }
  /// The final name.
  const std::string& path() const { return path_; }
  /// The temporary name.
  const std::string& path_while_writing() const { return temporary_path_; }

 private:
  [[noreturn]] void fail(const char* what) const;

  static inline bool has_standard_output_ = false;

  std::string path_;
  std::string temporary_path_;
  bool has_reader_ = true;
  std::FILE* file_ = nullptr;
};

/// Renames all closed `files` to their final names; returns these, one on each line.
std::string commit_all(const std::vector<std::unique_ptr<OutputFile>>& files);

/// Throws InputError if one of `outputs` is one of `inputs` or given twice. Ignores empty names.
void refuse_same_files(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs);

/// A folder, created if missing. Created folders are removed if they stay empty.
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
