// SPDX-License-Identifier: Apache-2.0
// Sunder on a host's own Vulkan device: the solver's fields land in vertex buffers on the device,
// for the host's shaders, with no read-back. Needs no Vulkan header: dispatchable handles
// (VkInstance, VkPhysicalDevice, VkDevice, VkQueue, VkCommandBuffer) are passed as void*, others
// (VkBuffer, VkSemaphore) as 64-bit numbers.
//
// The library creates its own buffers, pipelines and command buffers on the device, submits to the
// one queue that it is lent, and destroys what it created with the simulation, which must happen
// before the host destroys the device. It never destroys, resets or waits for anything of the
// host's. After any failure the host's device is as usable as before.
//
// sunder_simulation_step submits its compute work to the lent queue and waits for it, under the
// lock if one is given. Then either sunder_vulkan_record or sunder_vulkan_submit brings the fields
// to the buffers.
#ifndef SUNDER_SUNDER_VULKAN_H
#define SUNDER_SUNDER_VULKAN_H

#include <sunder/sunder.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Features of VkPhysicalDeviceFeatures and VkPhysicalDeviceVulkan12Features that the host enabled.
enum {
  SUNDER_VULKAN_SHADER_FLOAT64 = 1,     ///< without it: fp32, route inverse, deferred
  SUNDER_VULKAN_SHADER_INT64 = 2,       ///< used on lavapipe when it is there
  SUNDER_VULKAN_TIMELINE_SEMAPHORE = 4  ///< needed by sunder_vulkan_submit with a semaphore
};

/// Part of a VkBuffer. This struct has no version: it never changes.
typedef struct sunder_vulkan_buffer {
  uint64_t buffer;  ///< VkBuffer; 0: none
  uint64_t offset;  ///< [bytes]
  uint64_t size;    ///< [bytes]
} sunder_vulkan_buffer;

#define SUNDER_VULKAN_BUFFER_INIT \
  { 0, 0, 0 }

typedef void (*sunder_vulkan_function)(void);
/// PFN_vkGetInstanceProcAddr.
typedef sunder_vulkan_function (*sunder_vulkan_get_function)(void* instance, const char* name);
typedef void (*sunder_vulkan_lock_function)(void* user);

typedef struct sunder_vulkan_host {
  uint32_t struct_size;
  uint32_t api_version;  ///< VkApplicationInfo::apiVersion of the instance, at least 1.2
  sunder_vulkan_get_function get_instance_proc_addr;
  void* instance;
  void* physical_device;
  void* device;
  void* queue;            ///< must be able to compute
  uint32_t queue_family;  ///< of the queue
  uint32_t features;      ///< a sum of SUNDER_VULKAN_*
  /// Called around each vkQueueSubmit, when other threads of the host use the queue. Both or none.
  sunder_vulkan_lock_function lock, unlock;
  void* lock_user;
  /// Buffers of the host's to write to, with usage STORAGE_BUFFER, offset a multiple of 256, at
  /// least the sizes that sunder_vulkan_display states; 0: the library makes its own, with usage
  /// VERTEX_BUFFER | STORAGE_BUFFER | TRANSFER_SRC, for queues of `queue_family` alone. Who draws
  /// on a queue of another family lends buffers that both families share
  /// (VK_SHARING_MODE_CONCURRENT), or transfers their ownership itself.
  sunder_vulkan_buffer displacement, stress, live;
} sunder_vulkan_host;

#define SUNDER_VULKAN_HOST_INIT                                                          \
  {                                                                                      \
    sizeof(sunder_vulkan_host), 0, NULL, NULL, NULL, NULL, NULL, 0, 0, NULL, NULL, NULL, \
        SUNDER_VULKAN_BUFFER_INIT, SUNDER_VULKAN_BUFFER_INIT, SUNDER_VULKAN_BUFFER_INIT  \
  }

/// A simulation on the host's device. The scene's backend must be auto or vulkan.
/// What the host hands over is checked before anything is prepared: SUNDER_ERROR_NULL for a handle
/// or function, SUNDER_ERROR_VALUE for a queue family that the device does not have, a bit of
/// `features` that has no name here or an offset, SUNDER_ERROR_SIZE for a buffer that is too small;
/// SUNDER_ERROR_DEVICE names a version, feature or function that is missing.
SUNDER_API sunder_status sunder_vulkan_create(sunder_scene scene, const sunder_vulkan_host* host,
                                              const sunder_callbacks* callbacks,
                                              sunder_simulation* simulation);

typedef struct sunder_vulkan_display {
  uint32_t struct_size;
  uint32_t nodes, tets;
  uint32_t reserved;
  sunder_vulkan_buffer displacement;  ///< per node, stride 16: x, y, z [mm] in fp32, and 0
  sunder_vulkan_buffer stress;  ///< per element, stride 8: yield measure [MPa], its ratio to yield
  sunder_vulkan_buffer live;    ///< per element, stride 4: uint32, 1, or 0 where destroyed
} sunder_vulkan_display;

#define SUNDER_VULKAN_DISPLAY_INIT                                                                \
  {                                                                                               \
    sizeof(sunder_vulkan_display), 0, 0, 0, SUNDER_VULKAN_BUFFER_INIT, SUNDER_VULKAN_BUFFER_INIT, \
        SUNDER_VULKAN_BUFFER_INIT                                                                 \
  }

/// Where the fields are. Stress is 0 when it was left out of the scene.
SUNDER_API sunder_status sunder_vulkan_get_display(sunder_simulation simulation,
                                                   sunder_vulkan_display* display);
/// Records one dispatch into `command_buffer` (VkCommandBuffer of the lent queue's family, in the
/// recording state, outside a render pass) that brings the fields of the last step to the buffers.
/// It waits for all earlier commands of the queue; all later commands of the queue, in any stage,
/// see what it wrote. It leaves bound: a compute pipeline, descriptor set 0 of its layout, push
/// constants. Nothing is copied or submitted. The host must have the command buffer executed and
/// completed before the next step of this simulation; it may execute it again then.
SUNDER_API sunder_status sunder_vulkan_record(sunder_simulation simulation, void* command_buffer);

typedef struct sunder_vulkan_signals {
  uint32_t struct_size;
  uint32_t reserved;
  uint64_t wait_semaphore;  ///< timeline VkSemaphore; 0: none
  uint64_t wait_value;      ///< the buffers are written after this is reached
  uint64_t signal_semaphore;
  uint64_t signal_value;  ///< reached when the buffers hold the fields
} sunder_vulkan_signals;

#define SUNDER_VULKAN_SIGNALS_INIT \
  { sizeof(sunder_vulkan_signals), 0, 0, 0, 0, 0 }

/// The same in a submit of its own: waits, writes the buffers, signals, and returns at once. The
/// next step waits for it, so what it waits for must be under way.
SUNDER_API sunder_status sunder_vulkan_submit(sunder_simulation simulation,
                                              const sunder_vulkan_signals* signals);

/* ---- What the driver makes of the kernels ---------------------------------------------------- */

/// Simulations made of the scene from now on begin with these bytes, which
/// sunder_vulkan_pipeline_cache gave in an earlier run: on some drivers they start sooner. They are
/// copied. Bytes of another device or driver, cut or changed ones are ignored, with a warning of
/// the simulation. `bytes` may be null with size 0: none.
SUNDER_API sunder_status sunder_vulkan_set_pipeline_cache(sunder_scene scene, const uint8_t* bytes,
                                                          size_t size);
/// The bytes to keep, of a simulation on any Vulkan device, the host's or another; without one,
/// what was handed in. Kernels come with a simulation and with its first events, so it is best
/// asked at the end. `length` is how many there are; they are written where `capacity` is enough,
/// else SUNDER_ERROR_SIZE. `bytes` may be null with capacity 0: then `length` alone is asked for.
SUNDER_API sunder_status sunder_vulkan_pipeline_cache(sunder_simulation simulation, uint8_t* bytes,
                                                      size_t capacity, size_t* length);

/* ---- The surface, in buffers of the host's --------------------------------------------------- */

/// Items of one kind in a VkBuffer of the host's. This struct has no version: it never changes.
typedef struct sunder_vulkan_items {
  uint64_t buffer;  ///< VkBuffer; 0: not wanted
  uint64_t offset;  ///< of the first item [bytes], a multiple of 4
  uint64_t size;    ///< [bytes], from the offset on
  uint32_t usage;   ///< VkBufferUsageFlags that it was made with; STORAGE_BUFFER among them
  uint32_t stride;  ///< from one item to the next [bytes], a multiple of 4; 0: none lies between
} sunder_vulkan_items;

#define SUNDER_VULKAN_ITEMS_INIT \
  { 0, 0, 0, 0, 0 }

/// Where a host's renderer wants what sunder_simulation_surface and sunder_simulation_skin tell.
/// Several may lie in one VkBuffer, places and normals of a vertex side by side for one.
typedef struct sunder_vulkan_surface {
  uint32_t struct_size;
  uint32_t reserved;
  sunder_vulkan_items places;      ///< per node of the body: float x, y, z [mm]
  sunder_vulkan_items normals;     ///< per node: float x, y, z, unit; 0 for nodes inside
  sunder_vulkan_items triangles;   ///< per triangle: three uint32, its nodes: an index buffer
  sunder_vulkan_items facts;       ///< per triangle: int32 element, piece, opened
  sunder_vulkan_items skin;        ///< per vertex of the skin: float x, y, z [mm]
  sunder_vulkan_items skin_lives;  ///< per vertex: uint32, 0 where what carries it is destroyed
  /// Per triangle, of its element: float maximum shear stress [MPa], ratio to yield (0: it cannot
  /// break), largest principal strain by magnitude (of sym grad u by law linear, else of U - I) and
  /// largest displacement [mm]. The first two are 0 where the simulation leaves stress out.
  sunder_vulkan_items values;
} sunder_vulkan_surface;

#define SUNDER_VULKAN_SURFACE_INIT                                                        \
  {                                                                                       \
    sizeof(sunder_vulkan_surface), 0, SUNDER_VULKAN_ITEMS_INIT, SUNDER_VULKAN_ITEMS_INIT, \
        SUNDER_VULKAN_ITEMS_INIT, SUNDER_VULKAN_ITEMS_INIT, SUNDER_VULKAN_ITEMS_INIT,     \
        SUNDER_VULKAN_ITEMS_INIT, SUNDER_VULKAN_ITEMS_INIT                                \
  }

/// Lends buffers for the surface, in place of those before; null: takes them back, which the host
/// does before it destroys them. `host`: null where the simulation is on the host's device
/// (sunder_vulkan_create): its displacement is read there, and nothing crosses. For any other
/// simulation, as one with cracks that split or on backend cpu, it names the device of the buffers,
/// as sunder_vulkan_create is told (its own three buffers are not read): then the displacement is
/// written to mapped memory, once a recording, with maximum shear and ratio to yield where `values`
/// are wanted, and the rest is done on the device all the same. The
/// skin is the one that the simulation has by now. SUNDER_ERROR_ORDER, and nothing changes: `host`
/// is null and the simulation is not on a host's device, or the other way round; a skin is wanted
/// and there is none. SUNDER_ERROR_VALUE: an offset, a stride or a usage that cannot be.
SUNDER_API sunder_status sunder_vulkan_lend_surface(sunder_simulation simulation,
                                                    const sunder_vulkan_host* host,
                                                    const sunder_vulkan_surface* buffers);
/// Follows what has happened, as sunder_simulation_surface, whose result `surface` gets (may be
/// null), and records what brings it to the buffers: all places, normals, values and the skin, and
/// of triangles and facts those that have changed since the recording before. Places in the index
/// buffer that have become free name node 0 three times. As sunder_vulkan_record, but the command
/// buffer is executed once, in the order of recording, and completed before the next recording and
/// the next step; one that is dropped is made good by lending the buffers again. SUNDER_ERROR_SIZE,
/// and nothing is recorded: a buffer has become too small; `surface` tells what is there, and the
/// sentence how many bytes it takes. SUNDER_ERROR_ORDER: no buffers are lent, the skin was given
/// anew since, or there was no step yet on the host's device.
SUNDER_API sunder_status sunder_vulkan_record_surface(sunder_simulation simulation,
                                                      void* command_buffer,
                                                      sunder_surface* surface);

#ifdef __cplusplus
}
#endif
#endif
