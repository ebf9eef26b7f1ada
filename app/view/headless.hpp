// SPDX-License-Identifier: Apache-2.0
// A session without a window: pictures, a film strip, and the recording as a scene.
#pragma once

#include <functional>
#include <optional>

#include "app/output/result_folder.hpp"
#include "app/view/painter.hpp"
#include "app/view/session.hpp"

namespace sunder::app {

struct HeadlessPlan {
  const Inputs* inputs = nullptr;  ///< null: the scene's steps, one a picture
  int frames = 1;
  /// The scene's text of an origin, as it stands beside the recorded inputs.
  std::function<std::string(const Origin&)> recording;
  std::function<void(int frame)> progress;
  /// The device was lost under a picture: another painter, with the session on its device. Throws
  /// DeviceError where there is none; without it that is told at once.
  std::function<Painter&(const std::string& why)> renew;
};

struct HeadlessOutcome {
  std::vector<std::string> files;
  std::optional<std::string> failure;  ///< of a step: it ended there, and what there is was written
  std::optional<std::string> lost;     ///< the device for good: there are pictures and a recording
  bool inputs_left = false;            ///< the pictures were over before the inputs
  /// Of all pictures together: what a frame is computed in, copied out in, drawn in, and written as
  /// PNG in.
  struct Stage {
    double seconds = 0, processor_seconds = 0;
  } stepping, showing, drawing, writing;
  int pictures = 0;
};

/// Writes into the folder, which was cleared. Throws InputError for an input that cannot be done.
[[nodiscard]] HeadlessOutcome play(Session& session, Painter& painter, ResultFolder& folder,
                                   const HeadlessPlan& plan);

}  // namespace sunder::app
