// SPDX-License-Identifier: Apache-2.0
#include "output/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/system/system.h"
#include "output/lasting_effect.h"
#include "recordings/recording_files.h"

namespace condyle::host {
OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  if (path_ == "-") {
    temporary_path_ = path_;
    file_ = duplicate_standard_output();
    if (file_ == nullptr) fail("standard output cannot be written");
    has_standard_output_ = true;
    has_reader_ = !is_on_disk(file_);
    return;
  }
  std::error_code no_link;
  const auto target = std::filesystem::canonical(path_, no_link);
  if (!no_link && std::filesystem::is_symlink(path_) && std::filesystem::is_regular_file(target)) {
    path_ = target.string();  // replaces the target of a link, not the link
  }
  temporary_path_ = path_;
  const auto status = std::filesystem::status(path_, no_link);
  if (std::filesystem::is_directory(status)) {
    throw InputError(path_, "is a directory", "give a file inside it");
  }
  const bool is_written_directly =
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  file_ = is_written_directly ? std::fopen(path_.c_str(), "wb") : make_file_beside(temporary_path_);
  if (file_ == nullptr) fail("cannot be written");
  has_reader_ = !is_on_disk(file_);
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) {
    // Discards the buffer, and does not wait for a reader.
    if (path_ != "-") discard_unread(file_);
    std::fclose(file_);
  }
  if (!temporary_path_.empty() && temporary_path_ != path_) std::remove(temporary_path_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot be written");
}

void OutputFile::close() {
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail("cannot be written");
}

void OutputFile::commit() {
  if (temporary_path_ != path_) {
    std::error_code error;  // on Windows, std::rename replaces no file
    std::filesystem::rename(temporary_path_, path_, error);
    errno = error.value();
    if (error) fail("cannot be renamed");
  }
  has_lasting_effect = true;
  temporary_path_.clear();
}

void OutputFile::fail(const char* what) const {
  if (path_ == "-") {
    throw InputError("standard output", fmt::format("{}: {}", what, std::strerror(errno)),
                     "redirect it to a file or pipe that accepts the rows");
  }
  throw InputError(path_, fmt::format("{}: {}", what, std::strerror(errno)),
                   "check the folder, its permissions and the space on the disk");
}

std::string commit_all(const std::vector<std::unique_ptr<OutputFile>>& files) {
  std::string names;
  for (const auto& file : files) {
    file->commit();
    names += clean_line(file->path()) + "\n";
  }
  return names;
}

void refuse_same_files(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs) {
  const auto is_same = [](const std::string& a, const std::string& b) {
    std::error_code missing;
    return std::filesystem::equivalent(a, b, missing) ||
           std::filesystem::weakly_canonical(a, missing) ==
               std::filesystem::weakly_canonical(b, missing);
  };
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const std::string& input : inputs) {
      if (input.empty()) continue;
      const std::vector<std::string> files = recording_files(input);
      if (is_same(input, outputs[i]) ||
          std::any_of(files.begin(), files.end(),
                      [&](const std::string& file) { return is_same(file, outputs[i]); })) {
        throw InputError(outputs[i], "is also an input", "write to another file");
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      // A device may receive several outputs.
      if (!outputs[k].empty() && is_same(outputs[k], outputs[i]) &&
          !std::filesystem::is_character_file(outputs[i])) {
        throw InputError(outputs[i], "is given for two outputs", "give each output its own file");
      }
    }
  }
}

OutputFolder::OutputFolder(const std::string& path) : path_(std::filesystem::absolute(path)) {
  for (auto folder = path_; !std::filesystem::exists(folder); folder = folder.parent_path()) {
    first_made_ = folder;
  }
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (!error && !std::filesystem::is_directory(path_)) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) throw InputError(path, "cannot be made: " + error.message(), "give another folder");
}

OutputFolder::~OutputFolder() {
  if (first_made_.empty()) return;
  std::error_code error;
  // remove() keeps folders that are not empty.
  for (auto folder = path_; !error && std::filesystem::remove(folder, error);) {
    if (folder == first_made_) break;
    folder = folder.parent_path();
  }
}

}  // namespace condyle::host
