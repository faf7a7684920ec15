// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "input_error.h"

namespace condyle::host {

OutputFile::OutputFile(std::string path) : path_(std::move(path)), temporary_path_(path_) {
  struct stat status = {};
  const bool exists = stat(path_.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) {
    if (S_ISDIR(status.st_mode)) {
      throw InputError(path_, "is a directory", "name a file inside it");
    }
    file_ = std::fopen(path_.c_str(), "wb");
  } else {
    temporary_path_ += ".partial-XXXXXX";
    const int descriptor = mkstemp(temporary_path_.data());
    if (descriptor >= 0) {
      const mode_t mask = umask(0);
      umask(mask);
      if (fchmod(descriptor, exists ? status.st_mode & 0777 : 0666 & ~mask) == 0) {
        file_ = fdopen(descriptor, "wb");
      }
    }
  }
  if (file_ == nullptr) fail("cannot be written");
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!temporary_path_.empty() && temporary_path_ != path_) unlink(temporary_path_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot be written");
}

void OutputFile::commit() {
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail("cannot be written");
  if (temporary_path_ != path_ && std::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    fail("cannot be given its name");
  }
  temporary_path_.clear();
}

void OutputFile::fail(const char* what) const {
  throw InputError(path_, fmt::format("{}: {}", what, std::strerror(errno)),
                   "check the folder, its permissions and the space on the disk");
}

}  // namespace condyle::host
