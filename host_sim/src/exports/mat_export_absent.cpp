// SPDX-License-Identifier: Apache-2.0
// MAT files where condyle is built without libmatio: on Windows.
#include "exports/export_format.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

Exported export_mat(const ExportData&, const TableForm&, const std::string& out) {
  throw InputError(out, "would be a MAT file, which condyle writes on Linux only",
                   "write CSV, which MATLAB reads with readtable: --format wide");
}

}  // namespace condyle::host
