// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace condyle::testing_support {

/// A folder that lives as long as the object.
class TemporaryFolder {
 public:
  TemporaryFolder() : TemporaryFolder(usual()) {}
  explicit TemporaryFolder(const std::filesystem::path& parent) {
    std::string name = (parent / "condyle-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
    // Other users read it, so that a test may run the command as one of them.
    std::filesystem::permissions(path_, std::filesystem::perms(0755));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  /// Where writing waits for no disk, if there is such a place.
  static std::filesystem::path in_memory() {
    const char* const memory = "/dev/shm";
    return access(memory, W_OK) == 0 ? std::filesystem::path(memory) : usual();
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  /// Writes `content` to the file `name` in the folder and returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    const std::string path = *this / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  /// Number of files and folders inside.
  std::ptrdiff_t count() const {
    return std::distance(std::filesystem::directory_iterator(path_),
                         std::filesystem::directory_iterator());
  }

 private:
  // Short, because a socket's name has at most 107 bytes.
  static std::filesystem::path usual() {
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    return folder.native().size() <= 40 ? folder : std::filesystem::path("/tmp");
  }

  std::filesystem::path path_;
};

/// All of a file.
inline std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

}  // namespace condyle::testing_support
