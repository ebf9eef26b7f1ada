// SPDX-License-Identifier: Apache-2.0
// Fields of the last finished frame, for a thread of their own.
#include <algorithm>

#include "c/simulation.hpp"
#include "c/structs.hpp"
#include "sunder/finished_frames.hpp"

namespace sunder::c {
namespace {

class FramesObject final : public Object {
 public:
  static constexpr const char* kName = "frames";

  FramesObject(std::shared_ptr<FinishedFrames> frames,
               std::shared_ptr<const std::atomic<bool>> gone)
      : frames_(std::move(frames)), gone_(std::move(gone)) {}

  const FinishedFrame& take() {
    require_living();
    return *(frame_ = &frames_->take());
  }

  /// A field of the frame that was taken, if it is kept.
  [[nodiscard]] const FinishedFrame& of(bool FinishedFields::*field, const char* what) const {
    require_living();
    if (!(frames_->fields().*field)) {
      throw Failure(SUNDER_ERROR_ORDER,
                    std::string("these frames were made without ") + what + ": name it in fields");
    }
    if (frame_) return *frame_;
    throw Failure(SUNDER_ERROR_ORDER, "no frame was taken yet: call sunder_frames_take first");
  }

 private:
  void require_living() const {
    if (gone_->load()) {
      throw Failure(SUNDER_ERROR_HANDLE, "the simulation of these frames was destroyed");
    }
    if (frames_->gone()) {
      throw Failure(SUNDER_ERROR_HANDLE, "the simulation's frames were given to another handle");
    }
  }

  std::shared_ptr<FinishedFrames> frames_;
  std::shared_ptr<const std::atomic<bool>> gone_;
  const FinishedFrame* frame_ = nullptr;
};

/// Copies one field of the frame that was taken; rows of `width` values.
template <class T, class Of>
sunder_status read(sunder_frames frames, T* values, std::size_t size, bool FinishedFields::*field,
                   const char* what, std::size_t width, Of of) {
  return call<FramesObject>(frames, [&](FramesObject& object) {
    const auto& rows = of(object.of(field, what));
    require_size(size, width * rows.size(), "values");
    require(values, "values");
    const auto* data = reinterpret_cast<const T*>(rows.data());
    std::copy_n(data, size, values);
  });
}

}  // namespace
}  // namespace sunder::c

extern "C" {

using namespace sunder::c;

sunder_status sunder_frames_create(sunder_simulation simulation, uint32_t fields,
                                   const int32_t* nodes, size_t count, sunder_frames* frames) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(frames, "frames");
    constexpr std::uint32_t kKnown = SUNDER_FRAME_DISPLACEMENT | SUNDER_FRAME_STRESS |
                                     SUNDER_FRAME_YIELD_RATIO | SUNDER_FRAME_DESTROYED;
    if (fields == 0 || (fields & ~kKnown) != 0) {
      throw Failure(SUNDER_ERROR_VALUE, "fields = " + std::to_string(fields) +
                                            "; it must be a sum of SUNDER_FRAME_*, up to " +
                                            std::to_string(kKnown));
    }
    if (count > 0) require(nodes, "nodes");
    require_rows(count, "nodes");
    sunder::FinishedFields wanted;
    wanted.displacement = fields & SUNDER_FRAME_DISPLACEMENT;
    wanted.stress = fields & SUNDER_FRAME_STRESS;
    wanted.yield_ratio = fields & SUNDER_FRAME_YIELD_RATIO;
    wanted.destroyed = fields & SUNDER_FRAME_DESTROYED;
    for (std::size_t i = 0; i < count; ++i) {
      require_index(nodes[i], object.problem().node_count(), "nodes");
      wanted.nodes.push_back(nodes[i]);
    }
    *frames = new_handle<sunder_frames>(std::make_shared<FramesObject>(
        object.simulation().finished_frames(std::move(wanted)), object.gone));
  });
}

sunder_status sunder_frames_destroy(sunder_frames frames) { return destroy<FramesObject>(frames); }

sunder_status sunder_frames_take(sunder_frames frames, sunder_frame* frame) {
  return call<FramesObject>(frames, [&](FramesObject& object) {
    static_cast<void>(stated_size(frame, "frame"));
    const sunder::FinishedFrame& of = object.take();
    auto out = sized<sunder_frame>();
    out.step = of.step;
    out.number = of.number;
    out.node_count = of.node_count;
    write_struct(frame, out, "frame");
  });
}

sunder_status sunder_frames_displacement(sunder_frames frames, double* values, size_t size) {
  return read(
      frames, values, size, &sunder::FinishedFields::displacement, "displacement", 3,
      [](const auto& frame) -> const auto& { return frame.displacement; });
}

sunder_status sunder_frames_stress(sunder_frames frames, double* values, size_t size) {
  return read(
      frames, values, size, &sunder::FinishedFields::stress, "stress", 6,
      [](const auto& frame) -> const auto& { return frame.stress; });
}

sunder_status sunder_frames_yield_ratio(sunder_frames frames, double* values, size_t size) {
  return read(
      frames, values, size, &sunder::FinishedFields::yield_ratio, "the yield ratio", 1,
      [](const auto& frame) -> const auto& { return frame.yield_ratio; });
}

sunder_status sunder_frames_destroyed(sunder_frames frames, uint8_t* values, size_t size) {
  return read(
      frames, values, size, &sunder::FinishedFields::destroyed, "what is destroyed", 1,
      [](const auto& frame) -> const auto& { return frame.destroyed; });
}

}  // extern "C"
