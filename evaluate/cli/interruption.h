// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline {

/// From here on SIGINT, SIGTERM and SIGHUP end the process in order: what is being written is
/// removed, older results stay, and the exit code is 128 and the signal's number (130, 143, 129). A
/// thread waits for them, so that no handler runs in between and long work needs no checks. Signals
/// that the caller has the process ignore stay ignored. A file that grows beyond its limit
/// (SIGXFSZ) becomes an error of the write. Call before any other thread is started.
void endInOrderOnSignals();

/// Returns unless a signal is ending the process: then what fails, fails for that reason, and there
/// is nothing to be said of it.
void waitIfEnding();

}  // namespace plumbline
