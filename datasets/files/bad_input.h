// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/error.h"

namespace plumbline {

/// What is wrong with an input: what a program or a test asks for, where people read the message.
enum class InputFault {
  kOther,          ///< none of those below
  kBadOption,      ///< an option of the caller is out of its range, or contradicts another
  kMissingFile,    ///< a file or folder is not there, is of another kind, or cannot be read
  kUnwritable,     ///< a file or folder cannot be written, or stands in the way
  kForeignFiles,   ///< what stands where an output belongs is not ours, or was changed
  kInputInTheWay,  ///< an output would be written over an input
  kEmpty,          ///< a file or folder without content
  kTruncated,      ///< the content ends early
  kSyntax,         ///< YAML, JSON or an image that cannot be decoded
  kUnknownFile,    ///< none of the kinds of file that are read here
  kMissingKey,     ///< a key, a section or a named column is missing
  kBadColumns,     ///< a row of a table has too few or too many columns
  kBadNumber,      ///< a text that is no number, or another count of numbers than there should be
  kNotFinite,      ///< a number is nan or inf: what wrote it diverged
  kOutOfRange,     ///< a number outside its range
  kUnknownWord,    ///< a word that is none of those known
  kUnsupported,    ///< known, and not supported
  kBadOrder,       ///< stamps that do not ascend
  kDuplicate,      ///< a key or an id that is given twice
  kWrongUnit,      ///< numbers that only make sense in another unit
  kNotRigid,       ///< a matrix or quaternion that is no rotation
  kContradiction,  ///< parts of the input contradict each other
  kAmbiguous,      ///< the input holds several things of which one must be named
  // What an option can put right, so that a command line can name its own.
  kNoTarget,          ///< no description of the target
  kNoResolution,      ///< no size of a camera's images
  kNoCorners,         ///< images without corners where corners are needed
  kNoImuNoise,        ///< no description of the IMU, or one without noise densities
  kNoImuSamples,      ///< an IMU that is described, without samples
  kResultExists,      ///< an earlier output of ours
  kNoCache,           ///< a folder for what was found before cannot be made
  kNothingSelected,   ///< the interval that was asked for holds nothing
  kUnsupportedModel,  ///< a camera model that cannot be calibrated
  kUnknownCamera,     ///< no camera of that name, or one that is asked for twice
  kTooManyCameras,    ///< more or more various cameras than a tool holds
  kBadCameraRate,     ///< a rate of the images that a tool cannot hold
  kNoTopic,           ///< a bag without a topic that is needed, or one of another type
  kSeveralImus,       ///< a bag with topics of several IMUs, of which none is named
};

/// An InputError that says by a code what is wrong.
class BadInput : public InputError {
 public:
  BadInput(InputFault code, const std::string& path, int line, const std::string& message)
      : InputError(path, line, message), code_(code) {}
  /// A fault of what the caller asks for rather than of a file.
  BadInput(InputFault code, const std::string& message) : InputError(message), code_(code) {}

  InputFault code() const { return code_; }

 private:
  InputFault code_;
};

/// Several faults of one input, two or more. what() has a line of each.
class InputErrors : public InputError {
 public:
  explicit InputErrors(std::vector<InputError> all)
      : InputError(linesOf(all)), all_(std::move(all)) {}

  const std::vector<InputError>& all() const { return all_; }

 private:
  static std::string linesOf(const std::vector<InputError>& all) {
    std::string lines;
    for (const InputError& error : all)
      lines += (lines.empty() ? "" : "\n") + std::string(error.what());
    return lines;
  }

  std::vector<InputError> all_;
};

/// What is wrong, what was expected and what to do, in the words that the error shows. Options of a
/// command line are no words of this layer: who has them adds them by the code.
struct Complaint {
  InputFault code = InputFault::kOther;
  std::string what;
  std::string expected = {};  ///< follows "expected "; left out when empty
  std::string cure = {};
};

/// "FILE:LINE: what; expected ...; cure".
inline BadInput badInput(const std::string& path, int line, const Complaint& complaint) {
  std::string text = complaint.what;
  if (!complaint.expected.empty()) text += "; expected " + complaint.expected;
  if (!complaint.cure.empty()) text += "; " + complaint.cure;
  return {complaint.code, path, line, text};
}
/// Of the whole file: "FILE: what; expected ...; cure".
inline BadInput badInput(const std::string& path, const Complaint& complaint) {
  return badInput(path, 0, complaint);
}

}  // namespace plumbline
