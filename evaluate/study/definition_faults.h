// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "datasets/files/bad_input.h"

namespace plumbline::study_internal {

/// Gathers what is wrong with an input, so that all of it is said at once.
class FaultList {
 public:
  /// Whether reading went well; what it throws is kept.
  template <class Read>
  bool attempt(const Read& read) {
    try {
      read();
      return true;
    } catch (const InputErrors& errors) {
      found_.insert(found_.end(), errors.all().begin(), errors.all().end());
    } catch (const InputError& error) {
      found_.push_back(error);
      last_ = std::current_exception();
    }
    return false;
  }

  /// Throws the only one as it was, or several as InputErrors in the order of their lines.
  void raise() {
    if (found_.empty()) return;
    std::stable_sort(found_.begin(), found_.end(),
                     [](const InputError& a, const InputError& b) { return a.line() < b.line(); });
    if (found_.size() == 1) std::rethrow_exception(last_);
    throw InputErrors(std::move(found_));
  }

 private:
  std::vector<InputError> found_;
  std::exception_ptr last_;
};

}  // namespace plumbline::study_internal
