// SPDX-License-Identifier: Apache-2.0
// A session that goes on by itself, on a thread of its own: whoever draws it takes the last
// finished frame and never waits for a step.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
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
  /// How far apart steps that go on by themselves are at least.
  using Pace = std::chrono::duration<double>(const Problem& problem);
  /// Paused. The session must outlive it, and is nobody else's meanwhile. `pace`: null: none.
  explicit LiveSession(Session& session, Pace* pace = nullptr);
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

  /// A grip of the hand's. Its number here is the simulation's until the body is changed: a grip
  /// that goes along keeps it (input::Pose, input::Release).
  struct HeldNodes {
    int grip = 0;
    int of_body = 0;            ///< the simulation's number
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
    int body = 0;                       ///< Session::body, origin, said
    Origin origin;
    std::string said;
    /// Forces of the grips between frames, for a thread of the caller's; null: the backend has
    /// none. Others with each body.
    std::shared_ptr<InstrumentForces> forces;
    /// A body is being prepared, since when; empty: none is. What is shown is the one before it.
    std::string preparing;
    std::chrono::steady_clock::time_point since;
  };
  /// A copy of what is there; takes no longer than that.
  [[nodiscard]] Now now() const;
  /// Asks for the recording up to now; `receive` gets it on the session's thread.
  using Receive = std::function<void(const std::string& inputs, const Origin& origin)>;
  void record(Receive receive);
  /// Before all else that is to be done: the device that draws was lost, and there is another one
  /// (Session::renew). Pauses; `told` is the error then.
  void renew(std::string told);

 private:
  struct Task {
    std::optional<InputAction> what;
    Receive receive;
    std::string renewed;  ///< not empty: of renew()
  };
  void run();
  void perform(const Task& task);
  void take(const InputAction& what);
  void prepare(const InputAction& what);
  [[nodiscard]] int number_of(int grip);
  [[nodiscard]] bool find_grip(InputAction& what);
  void publish();

  using Clock = std::chrono::steady_clock;

  Session& session_;
  Pace* const pace_;
  std::shared_ptr<InstrumentForces> forces_;
  std::map<int, int> numbers_;  ///< of grips, as told, by the simulation's; on its thread
  int next_number_ = 0;
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
