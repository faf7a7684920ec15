// SPDX-License-Identifier: Apache-2.0
// The messages between a PC and a target that runs the estimator, each in a frame (link_frame.h).
// Numbers are little endian, floating-point numbers as their bits. No heap, no exceptions.
//
//   PC: hello         target: greeting, and fault if one is on record
//   PC: layout        target: accepted or refused
//   PC: start         target: accepted or refused
//   PC: report, ...   target: estimates; before one with which a conclusion was drawn, that
//   PC: finish        target: the estimates that waited, the last conclusion, then accepted
//   PC: reconnected   target: no answer; among reports
//   PC: ask_health    target: health; at any time
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/published/parameters.h"
#include "condyle/estimator/published/published_cascade.h"
#include "condyle/estimator/sample.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/hal/fixed_text.h"
#include "condyle/hal/link/link_frame.h"
#include "condyle/hal/report/layout_check.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_tracker.h"

namespace condyle::hal {

/// Version of this protocol. Both sides must have the same.
inline constexpr std::uint16_t kLinkVersion = 6;

/// LinkFrame::type.
enum class MessageType : std::uint8_t {
  // To the target
  hello = 1,
  layout,
  start,
  report,
  finish,
  ask_health,
  reconnected,
  // To the PC
  greeting = 65,
  accepted,
  refused,
  published_estimate,
  recommended_estimate,
  health,
  fault,
  conclusion,
};

/// True for the types above.
constexpr bool is_message_type(std::uint8_t type) {
  const auto is_between = [type](MessageType first, MessageType last) {
    return type >= static_cast<std::uint8_t>(first) && type <= static_cast<std::uint8_t>(last);
  };
  return is_between(MessageType::hello, MessageType::reconnected) ||
         is_between(MessageType::greeting, MessageType::conclusion);
}

/// Why a message is refused.
enum class RefusalReason : std::uint8_t {
  none,           ///< it is accepted
  wrong_size,     ///< it ends too early, or is too long
  unknown_value,  ///< of an enumeration, a flag, a text or an event
  out_of_range,
  not_finite,
  parameters_do_not_fit,    ///< each is in its range, but the combination is not valid (is_valid)
  wrong_version,            ///< not kLinkVersion
  unknown_type,             ///< of message
  not_expected,             ///< not at this point, such as a report before start
  unusable_layout,          ///< find_layout_problem
  coordinate_not_followed,  ///< the layout has no such point
  lag_too_long,             ///< for the target's memory (GreetingMessage)
  cannot_identify,  ///< friction and mass: the target has no memory for it, or there is no drive
  too_many_kernels  ///< for the target's memory (GreetingMessage)
};

/// Why a message is refused, and at which value.
struct [[nodiscard]] Refusal {
  RefusalReason reason = RefusalReason::none;
  std::uint16_t index = 0;  ///< of the value, in the order of the message
};

/// First message, which asks for a greeting.
struct HelloMessage {
  static constexpr MessageType kType = MessageType::hello;
  std::uint16_t version = kLinkVersion;
};

/// The device's reports.
struct LayoutMessage {
  static constexpr MessageType kType = MessageType::layout;
  ReportLayout layout;
};

/// Which estimator runs.
enum class EstimatorChoice : std::uint8_t { published, recommended };

/// Largest lag of the recommended estimator (samples). A target with little memory supports less.
inline constexpr int kMaxLinkLag = 16;
/// Longest nominal step (ns).
inline constexpr TimeNs kMaxNominalStepNs = 3600 * kNanosecondsPerSecond;

/// Begins a run. The layout's kind gives the number of axes.
struct StartMessage {
  static constexpr MessageType kType = MessageType::start;
  EstimatorChoice estimator = EstimatorChoice::recommended;
  std::uint8_t lag = 0;  ///< of the recommended estimator (samples)
  FollowedCoordinate followed;
  TimeNs nominal_step_ns = 0;  ///< for detecting gaps; 0: none are detected
  bool expects_drive = false;  ///< a sample without drive force is an event
  bool identifies = false;     ///< friction and mass, from the drive along the followed axis
  // Only the parameters that the run uses are sent; the rest stay as they are.
  PublishedParameters published;
  DrivenParameters recommended;
};

/// A report as it arrived at the PC.
struct ReportMessage {
  static constexpr MessageType kType = MessageType::report;
  TimeNs host_time_ns = 0;              ///< on the PC's monotonic clock
  std::span<const std::uint8_t> bytes;  ///< at most kMaxReportSize; if read, in the payload itself
};

/// No report follows: send the waiting estimates, and stop.
struct FinishMessage {
  static constexpr MessageType kType = MessageType::finish;
};

/// Requests a HealthMessage.
struct AskHealthMessage {
  static constexpr MessageType kType = MessageType::ask_health;
};

/// The device was away and is back: its counter and clock may restart.
struct ReconnectedMessage {
  static constexpr MessageType kType = MessageType::reconnected;
};

/// Why the target started.
enum class ResetCause : std::uint8_t {
  unknown,
  power_on,
  brown_out,
  reset_pin,
  software,
  watchdog,
  fault
};

/// Answer to hello; a target also sends it when it has started.
struct GreetingMessage {
  static constexpr MessageType kType = MessageType::greeting;
  std::uint16_t version = kLinkVersion;
  FixedText software_version{};
  FixedText core_name{};          ///< "Cortex-M7"
  std::uint8_t scalar_size = 8;   ///< of the estimates' numbers (bytes): 4 or 8
  bool identifies = false;        ///< it has the memory to identify friction and mass
  std::uint8_t longest_lag = 0;   ///< for which it has the memory (samples)
  std::uint8_t most_kernels = 0;  ///< for which it has the memory (motion_corrector.h)
  std::uint32_t boot_count = 0;   ///< since power was last switched on
  ResetCause reset_cause = ResetCause::unknown;
  bool has_fault = false;  ///< a FaultMessage follows

  friend bool operator==(const GreetingMessage&, const GreetingMessage&) = default;
};

/// A message was accepted and carried out.
struct AcceptedMessage {
  static constexpr MessageType kType = MessageType::accepted;
  MessageType message = MessageType::hello;
};

/// A message was refused.
struct RefusedMessage {
  static constexpr MessageType kType = MessageType::refused;
  std::uint8_t message = 0;  ///< its type, even if unknown
  Refusal refusal;
};

/// The sample that led to an estimate.
struct SampleStamp {
  std::uint64_t sequence = 0;
  TimeNs time_ns = 0;  ///< on the PC's clock
  bool time_valid = true;
};

/// An estimate of the published cascade, bit by bit. `Scalar`: float or double, as in the greeting.
template <class Scalar>
struct PublishedEstimateMessage {
  static constexpr MessageType kType = MessageType::published_estimate;
  SampleStamp sample;
  PublishedEstimate<Scalar> estimate;
};

/// The same for the recommended estimator.
template <class Scalar>
struct RecommendedEstimateMessage {
  static constexpr MessageType kType = MessageType::recommended_estimate;
  SampleStamp sample;
  RecommendedEstimate<Scalar> estimate;
};

/// Friction and mass, as concluded from the drive once a second and at the end. `Scalar` as above.
template <class Scalar>
struct ConclusionMessage {
  static constexpr MessageType kType = MessageType::conclusion;
  ImpedanceEstimate<Scalar> conclusion;
};

/// The target's counts since it started; reports and run: since `start`.
struct HealthMessage {
  static constexpr MessageType kType = MessageType::health;
  FrameCounts frames;  ///< from the PC
  ReportCounts reports;
  TransportCounts transport;
  // The run loop's counts
  std::uint64_t samples = 0, timeouts = 0, bad_reports = 0, disconnections = 0;
  std::array<std::uint64_t, kEventCount> events{};
  std::uint64_t uart_overruns = 0;  ///< bytes that the receiver lost
  std::uint64_t dropped_bytes = 0;  ///< for want of room, in either direction
  std::uint32_t stack_used_bytes = 0;
  std::uint32_t stack_size_bytes = 0;
  TimeNs uptime_ns = 0;
};

/// What stopped the target before its last start.
enum class FaultKind : std::uint8_t {
  hard,
  memory_management,
  bus,
  usage,
  non_maskable,
  stack_overflow,
  watchdog,
  assertion
};

/// State of the processor then (Armv7-M Architecture Reference Manual, B3.2).
struct FaultMessage {
  static constexpr MessageType kType = MessageType::fault;
  FaultKind kind = FaultKind::hard;
  std::uint32_t pc = 0, lr = 0;      ///< where it was, and its return address
  std::uint32_t cfsr = 0, hfsr = 0;  ///< fault status, configurable and hard
  std::uint32_t bfar = 0;            ///< address of a bus fault
};

/// Writes `message`, one of the above, to `payload`, for which kMaxPayload bytes suffice. Returns
/// its size; none if it does not fit, or has a value that the message cannot hold.
template <class Message>
std::optional<std::size_t> put(const Message& message, std::span<std::uint8_t> payload);

/// Reads `message`, one of the above, from the whole of `payload`, for any bytes. Do not use
/// `message` if it is refused. Each value read is in range by itself; check layouts with
/// find_layout_problem, and versions in the reader.
template <class Message>
Refusal get(std::span<const std::uint8_t> payload, Message& message);

}  // namespace condyle::hal
