// SPDX-License-Identifier: Apache-2.0
// A condyle without libmatio: MAT files are refused with a remedy. This program has its parts in
// the place of those with libmatio.
#include <gmock/gmock.h>

#include "exports/export_format.h"
#include "hosted/files/input_error.h"
#include "recordings/recording.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(WithoutMatio, AMatFileOfEachVersionAndByteOrderIsRefused) {
  const TemporaryFolder folder;
  for (const char* const end : {"\0\1IM", "\0\2IM", "\1\0MI", "\2\0MI"}) {
    const std::string path = folder.write("jaw.mat", std::string(124, ' ') + std::string(end, 4));
    EXPECT_THAT(message_of([&] { open_recording(path, RecordingOptions{}); }),
                AllOf(HasSubstr(path), HasSubstr("MAT file"), HasSubstr("writetable"),
                      HasSubstr("libmatio-dev")));
  }
}

TEST(WithoutMatio, ExportNamesAFormatThatMatlabReads) {
  const TemporaryFolder folder;
  const std::string path = folder / "jaw.mat";
  EXPECT_THAT(message_of([&] { export_mat(ExportData{}, TableForm{}, path); }),
              AllOf(HasSubstr(path), HasSubstr("--format wide"), HasSubstr("libmatio-dev")));
}

}  // namespace
}  // namespace condyle::host
