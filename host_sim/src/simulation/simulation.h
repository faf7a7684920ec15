// SPDX-License-Identifier: Apache-2.0
// A simulated subject with instruments: `condyle simulate` writes it, `sim:` plays it live and
// `condyle evaluate` repeats it over seeds.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "simulation/instrument.h"
#include "simulation/subject.h"

namespace condyle::host {

/// A scenario.
struct Scenario {
  std::string name;
  double duration_s = 30;
  std::uint64_t seed = 1;
  Axis axis = Axis::z;  ///< of the motion; z for a hinge
  SubjectParameters subject;
  FacebowModel facebow;
  DriveModel drive;
  EmgModel emg;
  HeadModel head;
};

/// One reading of a companion instrument.
struct Reading {
  TimeNs time_ns = 0;
  std::array<double, kMostMuscles> values{};  ///< force (N), envelopes, or acceleration
};

/// The result of one step of a simulation.
struct SimulatedData {
  std::vector<Sample> samples;
  std::vector<SubjectTruth> truths;  ///< at the samples' true instants, lost ones included
  std::vector<Reading> drive, emg, head;
  /// Clears the data, but keeps the memory.
  void clear() {
    samples.clear();
    truths.clear();
    drive.clear();
    emg.clear();
    head.clear();
  }
};

/// The simulation of a scenario, in constant memory.
class Simulation {
 public:
  Simulation(const Scenario& scenario, std::uint64_t seed);
  /// Simulates up to the next sampling instant of the facebow and appends the instruments' data up
  /// to it. False when the scenario's duration is over.
  bool advance(SimulatedData& data);
  double time_s() const { return subject_.time_s(); }

 private:
  // Streams of random numbers in addition to the facebow's.
  static constexpr std::uint64_t kDriveStream = 10, kEmgStream = 11, kHeadStream = 12;
  struct Channel {
    double rate_Hz = 0, delay_s = 0;
    std::uint64_t count = 0;
    double next_instant_s() const { return static_cast<double>(count) / rate_Hz; }
  };
  void read_channels(SimulatedData& data);

  Scenario scenario_;
  SimulatedSubject subject_;
  SimulatedFacebow facebow_;
  RandomGenerator drive_noise_, emg_noise_, head_noise_;
  Channel drive_, emg_, head_;
  SubjectTruth before_, after_;  // around the present instant
};

/// `before` and `after` one integration step apart: the state between them, by cubic interpolation
/// of the coordinate and linear interpolation of everything else.
SubjectTruth interpolate(const Jaw& jaw, const SubjectTruth& before, const SubjectTruth& after,
                         double time_s);

}  // namespace condyle::host
