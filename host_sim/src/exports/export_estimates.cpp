// SPDX-License-Identifier: Apache-2.0
#include "exports/export_estimates.h"

#include <type_traits>

#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "estimation/estimator_choice.h"
#include "estimation/replayed_drive.h"
#include "estimation/resampled_rows.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

ExportEstimates::ExportEstimates(const std::string& source, RecordingChoice choice,
                                 std::optional<double> resample_Hz,
                                 std::function<bool()> is_stopped)
    : source_(source),
      choice_(std::move(choice)),
      resample_Hz_(resample_Hz),
      is_stopped_(std::move(is_stopped)),
      facebow_(source, choice_.reading, 0, clock_) {
  if (facebow_.open() != hal::Status::ok) throw InputError(facebow_.problem());
  info_ = facebow_.info();
  choice_.check(source_, info_);
  parameters_ = load_recommended_for(EstimatorChoice(), info_, source_);
  refuse_long_step(parameters_, seconds(facebow_.run_settings(choice_.followed).nominal_step_ns),
                   source_, "its median step", kCheckTimes);
}

void ExportEstimates::run(const std::function<void(const EstimateRow&)>& take) {
  std::optional<ResampledRows> resampled;
  if (resample_Hz_) resampled.emplace(*resample_Hz_);
  firmware::with_hosted_sensor(
      {info_.kind, info_.has_drive, parameters_, 0, choice_.point(), choice_.followed.axis},
      [&]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
        const auto run_through = [&](auto& sensor) {
          firmware::RunCounts counts;
          static_cast<void>(firmware::run(
              facebow_, clock_, sensor, facebow_.run_settings(choice_.followed), counts,
              [&](const Sample&, const auto& estimate) {
                if (!estimate.is_ready) return;
                const EstimateRow row = row_of(estimate, choice_.followed.axis);
                resampled ? resampled->add(row, take) : take(row);
              },
              [&] { return is_stopped_() || !facebow_.problem().empty(); }));
        };
        if constexpr (firmware::kIdentifying<Sensor>) {
          DriveChannel* const own_drive = nullptr;
          ReplayedDriveSensor<Sensor> sensor(own_drive, 0.0, arguments...);
          run_through(sensor);
        } else {
          Sensor sensor(arguments...);
          run_through(sensor);
        }
      });
  if (!facebow_.problem().empty()) throw InputError(facebow_.problem());
}

}  // namespace condyle::host
