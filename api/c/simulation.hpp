// SPDX-License-Identifier: Apache-2.0
// A simulation behind a handle, with the host's callbacks.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "c/handles.hpp"
#include "c/scene.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "sunder/skin.hpp"
#include "sunder/surface.hpp"

namespace sunder::c {

class VulkanSurface;

class SimulationObject final : public Object {
 public:
  static constexpr const char* kName = "simulation";

  /// Makes the backend of a problem.
  using Create = std::function<CreatedBackend(std::shared_ptr<const Problem>, Needs,
                                              std::shared_ptr<PipelineCache>)>;

  /// `again`: `create` can be called later on as well, for a history that needs another backend.
  SimulationObject(const SceneObject& scene, const sunder_callbacks& callbacks,
                   const Create& create, bool again);

  /// Throws SUNDER_ERROR_CANCELLED, besides what Simulation::step throws. In motion `dt` [s] may
  /// take the place of the scene's step.
  [[nodiscard]] StepReport step(std::optional<double> dt);
  [[nodiscard]] StepReport step_within(double max_ms);
  void keep_history(int quick);
  void cancel() noexcept { cancelled_.store(true); }
  /// No callback runs from now on; false: one was running all the time until then.
  [[nodiscard]] bool silence(std::chrono::steady_clock::time_point until);
  /// The surface as the body is now.
  Surface& follow_surface();
  /// Nothing of a host's device is in use.
  [[nodiscard]] bool owns_device() const { return create_ && !draws_on_host_; }
  /// A host has lent buffers of its device, or (null) has them back.
  void draw_on(std::shared_ptr<VulkanSurface> surface);
  [[nodiscard]] VulkanSurface* vulkan_surface() { return vulkan_surface_.get(); }

  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  [[nodiscard]] Simulation& simulation() { return *simulation_; }
  [[nodiscard]] const Problem& problem() const { return simulation_->problem(); }
  [[nodiscard]] bool solved() const { return simulation_->steps_done() > 0; }
  [[nodiscard]] std::vector<std::string> warnings() const;

  const std::shared_ptr<PipelineCache> pipeline_cache;

  std::vector<TipState> tips;  ///< as last measured
  std::map<std::int32_t, Mark> marks;
  std::int32_t last_mark = 0;
  std::unique_ptr<Surface> surface;  ///< null: not asked for yet
  std::unique_ptr<Skin> skin;        ///< null: none was given
  int skins = 0;                     ///< given so far
  /// Fields as last lent, by sunder_field, and what was destroyed: where they lie never changes.
  std::array<std::vector<double>, 5> lent;
  std::vector<std::uint8_t> lent_destroyed;
  std::weak_ptr<Object> grips;  ///< the handle for forces between frames: one thread may ask
  /// Destroyed by the host, though a call of another thread may hold this object a little longer.
  const std::shared_ptr<std::atomic<bool>> gone = std::make_shared<std::atomic<bool>>(false);

 private:
  template <class Step>
  [[nodiscard]] StepReport take_step(Step&& step);
  void log(std::int32_t level, const std::string& text) const;
  void log_warnings();
  template <class Call>
  [[nodiscard]] bool call_back(Call&& call) const;
  /// False: the host cancels.
  [[nodiscard]] bool tell(std::int32_t phase, int events) const;
  void enter(std::int32_t phase) const;

  sunder_callbacks callbacks_;
  Create create_;  // empty: once is all
  std::unique_ptr<Simulation> simulation_;
  std::vector<std::string> creation_warnings_;
  std::set<std::string> told_;
  std::size_t warning_count_ = 0;
  int steps_;
  int events_ = 0;  // of this step
  std::atomic<bool> cancelled_{false};
  enum Calling { kIdle, kInside, kSilent };
  mutable std::atomic<int> calling_{kIdle};
  std::atomic<bool> draws_on_host_{false};
  std::shared_ptr<VulkanSurface>
      vulkan_surface_;  // goes before the simulation, whose device it has
};

[[nodiscard]] sunder_surface to_c(const Surface& surface);

/// Throws SUNDER_ERROR_ORDER for statics, which has no `what`.
void require_motion(const SimulationObject& object, const char* what);

}  // namespace sunder::c
