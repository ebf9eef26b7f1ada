// SPDX-License-Identifier: Apache-2.0
// What the Vulkan benchmark's rows share: the device, and where rows go.
#pragma once

#include <memory>
#include <string>

#include "gpu/kernels.hpp"
#include "sunder/backend.hpp"
#include "sunder/problem.hpp"
#include "vulkan_table.hpp"

namespace sunder::bench {

/// The device that a scene would get, with kernels of both storage precisions.
class Gpu {
 public:
  explicit Gpu(int device);
  [[nodiscard]] vulkan::Device& device() const { return *device_; }
  [[nodiscard]] const gpu::KernelFactory& kernels(bool fp64) const { return fp64 ? *k64_ : *k32_; }
  [[nodiscard]] Machine machine() const;
  /// Measured once, over buffers far larger than caches; read plus written.
  [[nodiscard]] double copy_gigabytes_per_second() const;

  /// What rows of one `name` work on, made once: Google Benchmark calls a row several times, and an
  /// inverse of 50,000 unknowns takes the host minutes. The next name's replaces it.
  template <class T, class Make>
  [[nodiscard]] T& kept(const std::string& name, const Make& make) const {
    if (name != kept_name_) {
      release();
      kept_ = std::shared_ptr<T>(make());
      kept_name_ = name;
    }
    return *static_cast<T*>(kept_.get());
  }
  /// Gives its memory to rows that need their own.
  void release() const {
    kept_name_.clear();
    kept_.reset();
  }

 private:
  std::unique_ptr<vulkan::Device> device_;
  gpu::Variant variant_;
  std::unique_ptr<gpu::KernelFactory> k32_, k64_;
  mutable double copy_ = 0;
  mutable std::string kept_name_;
  mutable std::shared_ptr<void> kept_;
};

struct Rows {
  const Gpu& gpu;
  Table& table;
  bool big = false;  ///< sizes that take a large GPU as well
  int device = 0;
};

/// Registers what to measure with Google Benchmark; `rows` must outlive the run.
void register_kernel_rows(const Rows& rows);
void register_system_rows(const Rows& rows);
void register_frame_rows(const Rows& rows);

/// By the device's clock, without what a submit costs; by the wall where that clock is off.
[[nodiscard]] std::function<double()> device_clock(vulkan::Device& device, const char* pass);

/// Of a frame with fracture.
[[nodiscard]] Needs field_needs();

/// The child process of a start-up row: milliseconds from nothing to the board's first stresses.
double start_up_ms(bool fp64, int device);

/// A square board of 6 cells^2 tetrahedra of one material, held at its top.
[[nodiscard]] std::shared_ptr<const Problem> plain_board(Index cells);

void add_row(const std::string& name, const std::function<void(benchmark::State&)>& run,
             double seconds = 0.3);

}  // namespace sunder::bench
