// SPDX-License-Identifier: Apache-2.0
#include "output/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "hosted/files/input_error.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing_support::read_file;
using testing_support::TemporaryFolder;

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  const std::string path = folder / "out.csv";
  {
    OutputFile file(path);
    file.write("abandoned");
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  EXPECT_EQ(folder.count(), 0);
  OutputFile file(path);
  file.write("kept");
  file.close();
  file.commit();
  EXPECT_EQ(read_file(path), "kept");
  EXPECT_EQ(folder.count(), 1);
}

TEST(OutputFile, LeavesTheOldFileUntilTheNewOneIsComplete) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out.csv", "old");
  std::filesystem::permissions(path, std::filesystem::perms(0640));
  {
    OutputFile file(path);
    file.write("half");
  }
  EXPECT_EQ(read_file(path), "old");
  OutputFile file(path);
  file.write("new");
  file.close();
  file.commit();
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms(0640));
}

TEST(OutputFile, HasAReaderUnlessItIsOnADisk) {
  const TemporaryFolder folder;
  EXPECT_FALSE(OutputFile(folder / "out.csv").has_reader());
  EXPECT_FALSE(OutputFile(folder.write("old.csv", "old")).has_reader());
  EXPECT_TRUE(OutputFile("/dev/null").has_reader());
  // The standard output, at first into a file.
  const int usual = dup(STDOUT_FILENO);
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const int on_disk = open((folder / "standard.csv").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  dup2(on_disk, STDOUT_FILENO);
  const bool is_read_on_disk = OutputFile("-").has_reader();
  dup2(pipe_ends[1], STDOUT_FILENO);
  const bool is_read_in_pipe = OutputFile("-").has_reader();
  dup2(usual, STDOUT_FILENO);
  for (const int file : {usual, on_disk, pipe_ends[0], pipe_ends[1]}) close(file);
  EXPECT_FALSE(is_read_on_disk);
  EXPECT_TRUE(is_read_in_pipe);
}

TEST(OutputFile, SaysWhereItCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_THROW(OutputFile(folder / "missing/out.csv"), InputError);
  EXPECT_THROW(OutputFile{folder.path().string()}, InputError);
  OutputFile full("/dev/full");
  EXPECT_THROW(
      {
        full.write(std::string(1 << 20, 'x'));
        full.close();
      },
      InputError);
}

}  // namespace
}  // namespace condyle::host
