// SPDX-License-Identifier: Apache-2.0
// Any bytes as a device profile: what is accepted decodes reports, all else is refused with a
// message.
#include <cstdlib>
#include <string_view>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_decoder.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/files/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  const std::string text(data, data + size);
  try {
    const hal::DeviceProfile profile = host::parse_device_profile("fuzz", text);
    if (hal::find_problem(profile)) std::abort();
    if (profile.descriptor_axes) return 0;
    std::vector<std::uint8_t> report(profile.minimum_size_bytes);
    if (profile.report_id) report[0] = *profile.report_id;
    hal::DecodedReport decoded;
    const hal::ReportFault fault =
        hal::ReportDecoder(hal::layout_of(profile)).decode(report, decoded);
    if (fault != hal::ReportFault::none && fault != hal::ReportFault::wrong_checksum) std::abort();
  } catch (const host::InputError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
