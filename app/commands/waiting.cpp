// SPDX-License-Identifier: Apache-2.0
#include "app/commands/waiting.hpp"

#include <chrono>
#include <cstdio>
#include <utility>

#include "app/system/process.hpp"

namespace sunder::app {
namespace {

constexpr int kPlainSeconds = 5;  // between two lines where there is no terminal

}  // namespace

Waiting::Waiting(std::string what, bool shown) : what_(std::move(what)) {
  if (shown) thread_ = std::thread([this] { tell(); });
}

Waiting::~Waiting() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void Waiting::tell() {
  const bool terminal = system::error_is_terminal();
  bool open = false;
  std::unique_lock lock(mutex_);
  for (int seconds = 1; !ended_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; });
       ++seconds) {
    if (!terminal && seconds % kPlainSeconds != 0) continue;
    std::fprintf(stderr, terminal ? "\r%s, %d s\033[K" : "%s, %d s\n", what_.c_str(), seconds);
    std::fflush(stderr);
    open = terminal;
  }
  if (open) std::fputs("\r\033[K", stderr);
}

}  // namespace sunder::app
