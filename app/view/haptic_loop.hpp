// SPDX-License-Identifier: Apache-2.0
// A hand that holds a grip, a thousand times a second: it follows the mouse, feels the body there
// by the forces between frames, and tells the session where it is. A picture waits for neither.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "app/inputs/inputs.hpp"
#include "sunder/instrument_forces.hpp"

namespace sunder::app {

class HapticLoop {
 public:
  /// `forces`: null where the backend has none; the hand moves all the same. `post` takes a new
  /// pose on this loop's thread.
  HapticLoop(std::shared_ptr<InstrumentForces> forces,
             std::function<void(const input::Pose&)> post);
  ~HapticLoop();
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;

  /// Others, of another body; as in the constructor.
  void feel(std::shared_ptr<InstrumentForces> forces);
  /// Takes a grip in hand where it is; the forces know it as `of_body`.
  void hold(const input::Pose& where, int of_body);
  /// Where the mouse wants it.
  void aim(const Vec3& place, const std::array<double, 4>& quaternion);
  /// The grip stays as it is.
  void let_go();

  struct Now {
    bool holds = false;
    Vec3 place = Vec3::Zero();  ///< of the hand [mm]
    Vec3 force = Vec3::Zero();  ///< on the body [N]
    Felt felt;
  };
  [[nodiscard]] Now now() const;

 private:
  void run();
  void tick();

  std::shared_ptr<InstrumentForces> forces_;
  std::function<void(const input::Pose&)> post_;
  mutable std::mutex mutex_;
  bool over_ = false, holds_ = false;
  input::Pose hand_, aim_, told_;
  int of_body_ = 0;
  Now now_;
  std::thread thread_;  // last: it uses all above
};

}  // namespace sunder::app
