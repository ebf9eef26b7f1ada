// SPDX-License-Identifier: Apache-2.0
// A body's surface for a host's renderer, into buffers of the host's own by kernels in its command
// buffer: places and normals of all nodes, those triangles that have changed, what all of them are
// coloured by, and a fine mesh that the body carries. Where the simulation is on the same device
// its displacement and stress are read there; else they are written to mapped memory.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/lent_field.hpp"
#include "sunder/skin.hpp"
#include "sunder/surface.hpp"

namespace sunder::gpu {

/// Items in a host's buffer, one every `stride` bytes; without a handle they are not wanted. Offset
/// and stride are multiples of four.
struct LentItems {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, bytes = 0;  ///< bytes: from the offset on
  std::uint32_t stride = 0;
};

struct SurfaceTargets {
  LentItems places, normals;   ///< of nodes: x, y, z in fp32
  LentItems triangles;         ///< three nodes, uint32
  LentItems facts;             ///< of triangles: element, piece, opened, int32
  LentItems skin, skin_lives;  ///< of vertices: x, y, z in fp32; uint32
  LentItems values;            ///< of triangles: sunder_vulkan_surface::values, four fp32
};

/// A target that cannot hold what there is.
struct TargetTooSmall {
  const char* what;
  std::uint64_t bytes, needed;
};

class SurfaceWriter {
 public:
  /// `field`: of a simulation on a host's device; of any other the kernels alone. `skin`: null
  /// where none is wanted. All of these must outlive it, as must the targets' buffers.
  SurfaceWriter(const LentField& field, const Simulation& simulation, const Skin* skin,
                const SurfaceTargets& targets);

  /// What does not fit, of the surface as it was last updated.
  [[nodiscard]] std::optional<TargetTooSmall> too_small(const Surface& surface) const;
  /// Brings the targets up to the surface as it was last updated, all of which must fit. What was
  /// recorded before must have been executed, once and in order: of triangles only those are
  /// written that have changed since. Outside a render pass; waits for all earlier commands of the
  /// queue, all later ones see what it wrote.
  void record(VkCommandBuffer commands, const Surface& surface);

 private:
  struct Target {
    vulkan::Buffer buffer;
    std::uint32_t at = 0, stride = 0;  // words
  };
  [[nodiscard]] Target bound(const LentItems& items);
  void upload_mesh();
  void upload_skin(const Skin& skin);
  void make_room(std::size_t nodes);
  void bind();
  void bind_changes();
  void write_displacement(std::size_t nodes);
  void write_stress();
  [[nodiscard]] shaders::SurfaceValuesPush values_push(const Surface& surface) const;
  [[nodiscard]] shaders::SurfaceChangesPush collect(const Surface& surface);
  void follow_triangles(const Surface& surface);
  void follow_elements();
  void touch(Index element);
  [[nodiscard]] std::array<Index, 4> corners_now(Index element) const;
  [[nodiscard]] std::uint32_t slot_of(const SurfaceTriangle& triangle) const;

  vulkan::Device& device_;
  const KernelFactory kernels_;
  const Simulation& simulation_;
  const vulkan::Buffer* displacement_;  // null: own_displacement_
  const vulkan::Buffer* stress_;        // null: own_stress_, or none where displacement_ is there
  SurfaceTargets given_;
  std::uint32_t elements_, vertices_ = 0;

  // What the host has of the device's.
  std::uint64_t drawn_ = 0;                    // version of the surface
  std::vector<std::uint32_t> slots_;           // 4 element + opposite, by place
  std::vector<std::uint32_t> shows_;           // by element
  std::vector<std::array<Index, 4>> corners_;  // likewise
  std::vector<std::uint32_t> parents_;         // by node
  std::vector<Index> touched_;                 // elements, of the record in work
  std::vector<std::uint8_t> is_touched_;
  std::vector<std::uint32_t> list_, of_elements_, of_nodes_;  // changes, likewise
  std::vector<double> wide_;                                  // displacement, as it is written
  std::vector<std::array<float, 4>> stresses_;                // likewise

  std::size_t room_ = 0, changes_room_ = 0;
  vulkan::Buffer rest_, first_, around_, on_device_corners_, on_device_shows_;
  vulkan::Buffer own_displacement_, own_stress_, on_device_parents_, changes_;
  vulkan::Buffer on_device_elements_;  // of triangles, for their values
  vulkan::Buffer shares_, carriers_, nothing_;
  Target places_, normals_, triangles_, facts_, skin_, skin_lives_, values_;
  std::unique_ptr<vulkan::Kernel> changes_kernel_, points_kernel_, skin_kernel_, values_kernel_;
  std::unique_ptr<vulkan::Binding> changes_binding_, points_binding_, skin_binding_,
      values_binding_;
};

}  // namespace sunder::gpu
