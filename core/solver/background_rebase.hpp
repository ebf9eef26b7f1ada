// SPDX-License-Identifier: Apache-2.0
// New bases computed while frames go on: a thread makes one of the body as it was when it was asked
// and follows every event since, whatever it changes: it reads the body's own record. Taken at a
// fixed event, so what it returns depends on the events alone, never on how long anything took.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "body/parted_body.hpp"
#include "linear_algebra/factor.hpp"
#include "solver/base_check.hpp"
#include "solver/deferred.hpp"

namespace sunder::solver {

/// A base with the damage laid over it.
struct Based {
  /// Follows an event of the body. Throws as laid_over() does.
  [[nodiscard]] bool follow(const fem::Event& event) const {
    if (!parted) return laid_over().follow(event);
    const fem::Change told = parted->translate(event);
    return laid_over().follow(told);
  }
  /// Throws NumericalError where there is none: an event before needed a new base, and the body as
  /// it is has none. It may still go back.
  [[nodiscard]] Deferred& laid_over() const;

  BaseCheck check;
  /// The body as the base has it, where nodes had parted by then: `deferred` is in its terms.
  std::shared_ptr<fem::PartedBody> parted;
  std::shared_ptr<const linear_algebra::Factor>
      factor;                          // what the base reads; empty: it is the intact one
  std::shared_ptr<Deferred> deferred;  // states to go back to hold it as well
};

/// Makes a base of a body with no damage over it yet, and checks it by a load; `work` is for a
/// factor on the way.
using MakeBase =
    std::function<Based(const fem::DamagedBody&, const Load&, const linear_algebra::FactorWork&)>;

/// Starting, following and taking a base allocate nothing on the frame's thread, but for what the
/// caller's MakeBase holds.
class BackgroundRebase {
 public:
  /// The body must outlive it; a base is taken so many events after its start. The thread rests
  /// before each thing that it does (CpuOptions::rest). `follows`: false where a base is taken as
  /// it was made, and whoever takes it follows the events since.
  BackgroundRebase(const fem::DamagedBody& body, int events, std::chrono::milliseconds rest,
                   bool follows = true);
  /// Gives up what is being made.
  ~BackgroundRebase();
  BackgroundRebase(const BackgroundRebase&) = delete;
  BackgroundRebase& operator=(const BackgroundRebase&) = delete;

  /// The body has recorded an event; to be told whether a base is being made or not.
  void follow();
  /// Starts a base of the body after all events so far. `load`: likely that of the frame that
  /// takes it.
  void start(const Load& load, MakeBase make);
  [[nodiscard]] bool making() const { return making_; }
  /// Events that the body has recorded since the start of what is being made.
  [[nodiscard]] int followed() const { return followed_; }
  /// The body is about to go back to the first `events` events: what is being made is of no use any
  /// more. Waits for nothing: the thread learns of it where it next looks.
  void go_back(std::size_t events);
  /// Once it has gone back: starts again what was being made then, of the body after `start`
  /// events.
  void start_again(std::size_t start, const Load& load, MakeBase make);
  /// Whether the next event is to find the base that is being made in place.
  [[nodiscard]] bool due() const { return making_ && followed_ >= events_; }
  /// Waits until the base is made, and every event followed where the thread does that; `based`
  /// goes to the thread to be freed, which takes as long as a frame. False, and nothing changes:
  /// not positive definite in double precision.
  [[nodiscard]] bool take(Based& based);
  /// The thread frees this; nothing else may wait to be freed.
  void free(Based&& based);
  /// Gives up the base that is being made, and waits until nothing that makes it is used any more.
  void give_up();
  /// Milliseconds that take() has waited so far.
  [[nodiscard]] double waited_ms() const { return waited_ms_; }

 private:
  enum class Phase { idle, asked, following };
  using Lock = std::unique_lock<std::mutex>;
  void ask(const Load& load, MakeBase make, std::size_t start);
  void drop();
  void run();
  void make(Lock& lock);
  void follow_next(Lock& lock);
  [[nodiscard]] bool read_next(std::uint64_t job);
  [[nodiscard]] bool work_waits() const;

  // The frame's.
  const fem::DamagedBody& of_;
  int events_, followed_ = 0;
  bool making_ = false;
  const bool follows_;
  double waited_ms_ = 0;
  // The thread's.
  std::chrono::milliseconds rest_;
  fem::DamagedBody body_;  // a copy that reads the same record
  fem::Change event_;
  Load load_of_job_;
  // Guarded by mutex_.
  std::mutex mutex_;
  std::condition_variable asked_, done_;
  Phase phase_ = Phase::idle;
  bool busy_ = false, quit_ = false;
  // Counts what is asked for and what is dropped: who works on an earlier one leaves no trace.
  std::uint64_t job_ = 0;
  bool astray_ = false;  // body_ may have followed events that are no more
  Load load_;
  MakeBase make_;
  Based result_, old_;
  std::size_t recorded_;   // events there are
  std::size_t at_;         // events that the thread has followed
  std::size_t start_ = 0;  // events before the base that is being made
  std::atomic<bool> unwanted_{false};
  std::thread thread_;  // last: it uses all above
};

/// A full check of a new base (frame_check.hpp). It solves for the load once more at the end: the
/// frame that takes the base finds its load known, and all memory touched. `complete` fills what a
/// solution leaves out.
void check_base(Based& based, const fem::DamagedBody& body, const Load& load,
                const std::function<void(Eigen::VectorXd&)>& complete);

}  // namespace sunder::solver
