// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM. A thread of its own waits for them, so that a signal ends the program within
// a second whatever the computing is at: a factorisation, a mesh in gmsh, a shader in the driver.
// The computing is asked to end by itself first; where it does not, it is left behind and what it
// had put aside is written without it. So no loop of the library asks whether it is to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace sunder::app {

constexpr int kInterruptedExit = 130;  // 128 + SIGINT, as shells have it

class Interruption {
 public:
  /// What a signal finds.
  struct Duty {
    std::string nothing;  ///< said where there are no results: "nothing was written"
    /// Takes back what lies on the disk: of a first signal where there are no results, of a second
    /// one in any case. Called from another thread than the computing, which goes on. False: all
    /// was written before, and stays.
    std::function<bool()> drop;
    /// Writes the results so far and returns the exit code; empty: there are none. Called once,
    /// from another thread than the computing, if that has not ended by itself after `grace`.
    std::function<int()> results;
    std::chrono::milliseconds grace{0};
  };

  /// Starts to wait. One at a time, since signals belong to the process.
  Interruption();
  /// A signal that comes from here on is nobody's.
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// A signal has come.
  [[nodiscard]] bool requested() const noexcept { return requested_.load(); }
  /// Since the first signal, which must have come.
  struct Since {
    double seconds, processor_seconds;  ///< of all threads together
  };
  [[nodiscard]] Since since_signal() const;

  /// Replaces what a signal finds and returns what it would have found. Does not return where
  /// that is under way. What `make` makes or takes away a signal finds whole: one that comes
  /// meanwhile waits. Passes on what `make` throws; nothing has changed then.
  Duty expect(const std::function<Duty()>& make);
  /// The computing ends by itself and writes its results: nobody else will. What still computes
  /// on other threads after a signal makes way for it. Does not return where somebody else does
  /// already.
  void claim();
  /// All is done: a signal from here on ends the program with this exit code and takes nothing
  /// back. Does not return where somebody else ends the program.
  void over(int exit_code);
  /// Ends the program at once, with what stands in stdout and without destructors: they would wait
  /// for threads that compute what nobody wants.
  [[noreturn]] void leave(int exit_code);

 private:
  void watch();
  void lower_priority_of_others() const;
  void first();
  void write_without_it();
  void drop(const std::string& what);
  /// Does not return where others end the program; then the lock is free.
  void stay_unless_free(std::unique_lock<std::mutex>& lock) const;

  std::atomic<bool> requested_{false}, ended_{false};
  std::chrono::steady_clock::time_point came_;  // set before requested_
  double processor_at_ = 0;                     // [s], likewise
  std::atomic<long> watcher_{0};                // the thread's number
  std::mutex mutex_;
  Duty duty_;
  bool claimed_ = false;  // the computing writes its results itself
  bool forced_ = false;   // duty_.results is under way
  std::optional<int> over_;
  std::thread thread_;  // last: it uses all above
};

/// What a signal finds while this lives; before and after, what it found before.
class Expecting {
 public:
  Expecting(Interruption& interruption, Interruption::Duty duty)
      : Expecting(interruption, [&] { return std::move(duty); }, {}) {}
  /// `make` makes what the duty takes back, `release` ends it; a signal finds both done or neither.
  Expecting(Interruption& interruption, const std::function<Interruption::Duty()>& make,
            std::function<void()> release)
      : interruption_(interruption),
        release_(std::move(release)),
        before_(interruption.expect(make)) {}
  ~Expecting() {
    static_cast<void>(interruption_.expect([this] {
      if (release_) release_();
      return std::move(before_);
    }));
  }
  Expecting(const Expecting&) = delete;
  Expecting& operator=(const Expecting&) = delete;

 private:
  Interruption& interruption_;
  std::function<void()> release_;
  Interruption::Duty before_;
};

}  // namespace sunder::app
