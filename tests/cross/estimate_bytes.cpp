// SPDX-License-Identifier: Apache-2.0
// Writes every estimate of a recording, each number's bytes: the same on every machine.
// usage: estimate_bytes INPUT OUTPUT_FOLDER
//   INPUT as of write_estimate_input. Published cascade and recommended estimator, this also 10
//   samples late, and of three points the pose, each in float and double: a file each.
#include <cstring>
#include <new>

#include "condyle/estimator/sensors/pose_sensor.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "estimate_input.h"
#include "estimate_writer.h"
#include "test_host.h"

namespace condyle::cross {
namespace {

/// The recording from its start, byte for byte.
class Input {
 public:
  explicit Input(const char* path)
      : file_(path, ByteFile::Use::read), has_next_(is_open() && file_.get(next_)) {}
  bool is_open() const { return file_.is_open(); }
  bool has_next() const { return has_next_; }
  std::uint8_t operator()() {
    const std::uint8_t byte = next_;
    has_next_ = file_.get(next_);
    return byte;
  }
  bool close() { return file_.close(); }

 private:
  ByteFile file_;
  std::uint8_t next_ = 0;
  bool has_next_;
};

constexpr int kLag = 10;  // samples

// What a run needs beside the stack, which is small on a microcontroller. One at a time.
template <class T>
T& place() {
  alignas(T) static std::byte memory[sizeof(T)];
  return *reinterpret_cast<T*>(memory);
}

/// Runs the sensor that `construct(memory, header)` makes over the recording at `input_path`.
template <class Sensor, class Construct>
bool write_run(const char* input_path, const char* folder, const char* name,
               Construct&& construct) {
  char path[256] = {};
  if (std::strlen(folder) + std::strlen(name) + 2 > sizeof path) return false;
  std::strcat(std::strcat(std::strcat(path, folder), "/"), name);
  Input& input = *new (&place<Input>()) Input(input_path);
  ByteFile& file = *new (&place<ByteFile>()) ByteFile(path, ByteFile::Use::write);
  if (!input.is_open() || !file.is_open()) return false;
  const EstimateHeader header = take_header(input);
  Sensor& sensor = *construct(&place<Sensor>(), header);
  SampleChecker checker(header.nominal_step_ns);
  EstimateWriter<ByteFile> write{file};
  while (input.has_next()) {
    const Sample sample = take_sample(input);
    write(sensor.process(sample, checker.check(sample)));
  }
  for (typename Sensor::Estimate waiting; sensor.drain(waiting);) write(waiting);
  return input.close() && file.close();
}

template <class Scalar>
bool write_published(const char* input, const char* folder, const char* name) {
  using Sensor = PublishedSensor<Scalar>;
  return write_run<Sensor>(input, folder, name, [](void* memory, const EstimateHeader& header) {
    return new (memory) Sensor(header.parameters);
  });
}

template <class Scalar, int kAxes>
bool write_recommended(const char* input, const char* folder, const char* name, int lag) {
  using Sensor = RecommendedSensor<Scalar, kAxes, kLag>;
  return write_run<Sensor>(input, folder, name, [lag](void* memory, const EstimateHeader&) {
    FollowedPoint followed;
    if constexpr (kAxes == 3) followed.body_point_m = Eigen::Vector3d(0.05, 0.03, 0.09);
    return new (memory) Sensor(MotionEstimatorParameters{}, lag, followed);
  });
}

template <int kAxes>
bool write_all_recommended(const char* input, const char* folder) {
  return write_recommended<float, kAxes>(input, folder, "recommended_float", 0) &&
         write_recommended<double, kAxes>(input, folder, "recommended_double", 0) &&
         write_recommended<float, kAxes>(input, folder, "recommended_late_float", kLag) &&
         write_recommended<double, kAxes>(input, folder, "recommended_late_double", kLag);
}

template <class Scalar>
bool write_pose(const char* input, const char* folder, const char* name) {
  using Sensor = PoseSensor<Scalar, 0>;
  return write_run<Sensor>(input, folder, name, [](void* memory, const EstimateHeader&) {
    return new (memory) Sensor(MotionEstimatorParameters{});
  });
}

bool write_all_of_points(const char* input, const char* folder) {
  return write_all_recommended<3>(input, folder) &&
         write_pose<float>(input, folder, "pose_float") &&
         write_pose<double>(input, folder, "pose_double");
}

}  // namespace

int test_program(int count, const char* const* arguments) {
  if (count != 2) {
    print("usage: estimate_bytes INPUT OUTPUT_FOLDER\n");
    return 2;
  }
  const char *input_path = arguments[0], *folder = arguments[1];
  Input& input = *new (&place<Input>()) Input(input_path);
  if (!input.is_open()) return 1;
  take_header(input);
  const bool has_one_axis = input.has_next() && take_sample(input).kind == SampleKind::one_axis;
  const bool written = input.close() &&
                       write_published<float>(input_path, folder, "published_float") &&
                       write_published<double>(input_path, folder, "published_double") &&
                       (has_one_axis ? write_all_recommended<1>(input_path, folder)
                                     : write_all_of_points(input_path, folder));
  if (!written) print("estimate_bytes: cannot read or write a file\n");
  return written ? 0 : 1;
}

}  // namespace condyle::cross
