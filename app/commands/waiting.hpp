// SPDX-License-Identifier: Apache-2.0
// A line on stderr that tells, while one long call runs, what it does and for how long.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace sunder::app {

/// From its construction to its end. On a terminal one line is kept up to date, elsewhere a line
/// appears every few seconds; what is done within a second leaves no trace.
class Waiting {
 public:
  Waiting(std::string what, bool shown);
  ~Waiting();
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  void tell();

  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace sunder::app
