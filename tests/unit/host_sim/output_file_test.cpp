// SPDX-License-Identifier: Apache-2.0
#include "output/output_file.h"

#include <gmock/gmock.h>

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
