// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace plumbline {

/// Bad input (a file, an option): thrown by readers and option checks, caught once in main, which
/// exits 2. what() reads "FILE:LINE: what is wrong; what was expected; what to do".
class InputError : public std::runtime_error {
 public:
  /// `line` counts from 1; 0 where the fault belongs to the whole file (then no ":LINE").
  InputError(const std::string& path, int line, const std::string& message);
  /// A fault of the command line rather than of a file.
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  const std::string& path() const { return path_; }
  int line() const { return line_; }

 private:
  std::string path_;
  int line_ = 0;
};

/// Why work that was asked for properly could not succeed.
enum class FailureReason {
  kTooFewViews,    ///< not enough corners, views or cameras to start from
  kNotObservable,  ///< the data leave a direction of the parameters free
  kNotConverged,   ///< the optimisation did not reach a minimum
  kNoOverlap,      ///< streams that must overlap (time, or views shared by cameras) do not
  kImplausible,    ///< data contradict their stated units, axes or target
};

/// Where a failure's cause most likely stands, for messages that name a file.
enum class FaultyInput {
  kSession,     ///< the recording as a whole
  kImuSamples,  ///< the IMU's samples
  kTarget,      ///< the description of the target
  kCameras,     ///< a calibration that was given
};

/// An expected failure: one line that says what and why, and one that says what to do (exit 1; 2
/// for kImplausible, where a file states what its data contradict).
struct Failure {
  FailureReason reason = FailureReason::kNotConverged;
  std::string message;
  std::string cure;
  FaultyInput input = FaultyInput::kSession;
};

/// A value or a Failure. Never ignore one: [[nodiscard]] on the type.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}            // NOLINT: implicit by design
  Result(Failure failure) : content_(std::move(failure)) {}  // NOLINT: implicit by design

  bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }
  /// The value; only after ok() (std::bad_variant_access otherwise).
  const T& value() const& { return std::get<T>(content_); }
  T& value() & { return std::get<T>(content_); }
  T&& value() && { return std::get<T>(std::move(content_)); }
  const T& operator*() const { return value(); }
  const T* operator->() const { return &value(); }
  /// The failure; only after !ok().
  const Failure& failure() const { return std::get<Failure>(content_); }

 private:
  std::variant<T, Failure> content_;
};

}  // namespace plumbline
