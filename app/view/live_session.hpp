// SPDX-License-Identifier: Apache-2.0
// A session that goes on by itself, on a thread of its own: whoever draws it takes the last
// finished frame and never waits for a step.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/view/session.hpp"

namespace sunder::app {

class LiveSession {
 public:
  /// Paused. The session must outlive it, and is nobody else's meanwhile. Steps that go on by
  /// themselves are `pace` apart at least.
  explicit LiveSession(Session& session, std::chrono::duration<double> pace = {});
  ~LiveSession();  ///< when the step in work is done
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// To be done before the next step, in order. What drives an instrument or poses a grip takes the
  /// place of the same before it that has not been done yet.
  void post(InputAction what);
  void pause(bool on);
  [[nodiscard]] bool paused() const { return paused_.load(); }
  /// Whoever draws has this version of the triangles (Painter::version).
  void drawn(std::uint64_t version) { drawn_.store(version); }

  /// A grip of the hand's.
  struct HeldNodes {
    int grip = 0;
    Vec3 place = Vec3::Zero();  ///< as posed last [mm]
    std::vector<Index> nodes;
  };
  struct Now {
    std::shared_ptr<const Shown> shown;  ///< the last finished frame
    std::vector<Vec3> values;            ///< of the instruments, driven or not (Hand::value)
    std::vector<HeldNodes> grips;  ///< that were grasped, in the order in which they took hold
    int undos = 0, redos = 0;
    bool done = false;                 ///< all steps
    std::optional<std::string> error;  ///< it has paused for: until something is done or it goes on
    std::vector<std::string> ruptures;  ///< the last of them, the newest last
  };
  /// Forces of the grips between frames, for a thread of the caller's; null: the backend has none.
  [[nodiscard]] const std::shared_ptr<InstrumentForces>& forces() const { return forces_; }
  /// A copy of what is there; takes no longer than that.
  [[nodiscard]] Now now() const;
  /// Asks for the recording up to now; `receive` gets it on the session's thread.
  void record(std::function<void(const std::string&)> receive);

 private:
  struct Task {
    std::optional<InputAction> what;
    std::function<void(const std::string&)> receive;
  };
  void run();
  void perform(const Task& task);
  void publish();

  using Clock = std::chrono::steady_clock;

  Session& session_;
  const std::chrono::duration<double> pace_;
  const std::shared_ptr<InstrumentForces> forces_;
  Clock::time_point due_;  ///< the next step, on the session's thread
  std::atomic<bool> paused_{true};
  std::atomic<std::uint64_t> drawn_{0};
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  bool over_ = false;
  Now now_;
  std::thread thread_;  // last: it uses all above
};

}  // namespace sunder::app
