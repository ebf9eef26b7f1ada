// SPDX-License-Identifier: Apache-2.0
// What a device's driver has made of the kernels, in the hands of a host: bytes that it keeps, in a
// file say, and hands to the next backend, which then starts sooner. They fit one driver on one
// device; others take no harm from them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sunder {

/// One backend uses it at a time, on the thread of its simulation.
class PipelineCache {
 public:
  PipelineCache() = default;
  /// Bytes that bytes() once returned; any others are ignored, with a warning of the backend.
  explicit PipelineCache(std::vector<std::byte> given) : bytes_(std::move(given)) {}
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;

  /// What to keep: of the kernels made so far, and of those that were handed in. Kernels come with
  /// a backend and with its first events. As handed in where no backend has taken it.
  [[nodiscard]] std::vector<std::byte> bytes() const { return now_ ? now_() : bytes_; }

  /// Why what was handed in is ignored; empty: it is not.
  [[nodiscard]] const std::string& ignored() const { return ignored_; }

  /// For backends: where the bytes come from as long as `user` lives, which then calls leave().
  void follow(const void* user, std::string ignored, std::function<std::vector<std::byte>()> now) {
    user_ = user;
    ignored_ = std::move(ignored);
    now_ = std::move(now);
  }
  void leave(const void* user) {
    if (user != user_ || !now_) return;
    std::vector<std::byte> last = now_();
    if (!last.empty()) bytes_ = std::move(last);
    now_ = {};
  }

 private:
  std::vector<std::byte> bytes_;
  std::string ignored_;
  const void* user_ = nullptr;
  std::function<std::vector<std::byte>()> now_;
};

}  // namespace sunder
