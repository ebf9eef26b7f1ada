// SPDX-License-Identifier: Apache-2.0
#include "gpu/cost_model.hpp"

#include <algorithm>

#include "gpu/host_update.hpp"

namespace sunder::gpu {
namespace {

/// Nominal rates of a kind of device.
struct Rates {
  double bytes;         // a second, from memory or, for small sets, the cache
  double submit;        // [s], with the fence
  double dispatch;      // [s], with its barrier
  double stress;        // [s] per element, by arithmetic
  double host_bytes;    // a second, of one core of the host
  double host_element;  // [s] per element of a product K u there
  double host_event;    // [s] of an event's small matrices there
};

constexpr double kTouched = 12;  // unknowns of a first fracture
// Of conjugate gradients, from the last solution to one under a larger load or with an element
// less: 490 to 500 on boards with frames 100 times stiffer, 208 to 229 without.
constexpr double kIterations = 500;
// Dispatches of one iteration, and bytes a node of its 13 vectors of four values and two places.
constexpr double kIterationDispatches = 7, kIterationBytes = 13 * 32 + 2 * 16;

Rates rates(const vulkan::PhysicalDevice& device) {
  switch (device.type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU:  // lavapipe on two cores
      return {8e9, 20e-6, 15e-6, 10e-9, 10e9, 120e-9, 60e-6};
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return {400e9, 20e-6, 5e-6, .05e-9, 10e9, 120e-9, 60e-6};
    default:
      return {40e9, 20e-6, 5e-6, .5e-9, 10e9, 120e-9, 60e-6};
  }
}

/// A frame's work, added up pass by pass.
class Work {
 public:
  explicit Work(const Rates& rates) : rates_(rates) {}
  void submit() { seconds_ += rates_.submit; }
  void pass(double bytes) { passes(1, bytes); }
  void passes(double dispatches, double bytes) {
    seconds_ += dispatches * rates_.dispatch + bytes / rates_.bytes;
    bytes_ += bytes;
  }
  void host(double bytes) { seconds_ += bytes / rates_.host_bytes; }
  void seconds(double s) { seconds_ += s; }
  [[nodiscard]] double milliseconds() const { return 1e3 * seconds_; }
  [[nodiscard]] double bytes() const { return bytes_; }

 private:
  Rates rates_;
  double seconds_ = 0, bytes_ = 0;
};

class Frame {
 public:
  Frame(const FrameShape& shape, const Rates& rates) : s_(shape), rates_(rates), work_(rates) {}

  [[nodiscard]] const Work& quiet() {
    solve(0, s_.grips > 0);
    return work_;
  }

  [[nodiscard]] const Work& with_fracture() {
    const double rows = static_cast<double>(s_.rows);
    work_.seconds(rates_.host_event);
    if (s_.eager) {
      work_.submit();  // the block that the event touches
      work_.pass(0);
      work_.submit();
      work_.pass(kTouched * rows * real());
      work_.pass(rows * rows * real());  // half of them, read and written
    } else if (!s_.cg) {
      work_.host(2 * kTouched * rows * sizeof(double));  // new exact columns
    }
    solve(kTouched, true);
    if (s_.eager || s_.cg) check();
    return work_;
  }

 private:
  [[nodiscard]] double real() const { return static_cast<double>(s_.real_bytes); }

  void solve(double touched, bool balance) {
    work_.submit();
    if (s_.cg) {
      state(true);
      work_.submit();
      iterate(kIterations);
      work_.submit();
      balance = true;
    } else {
      columns(touched);
    }
    if (s_.grips > 0) work_.pass(0);
    state(balance);
  }

  [[nodiscard]] bool few_loads() const { return s_.loaded <= kExactLoads; }
  [[nodiscard]] double exact(double touched) const {
    return touched + static_cast<double>(s_.grips + (few_loads() ? s_.loaded : 0));
  }

  /// u = X f by the columns that loads, grips and damage multiply.
  void columns(double touched) {
    const double rows = static_cast<double>(s_.rows);
    if (s_.eager) {
      work_.pass(rows * real() * static_cast<double>(s_.loaded));
      work_.pass(2 * rows * sizeof(double));
      return;
    }
    const double bytes = exact(touched) * rows * sizeof(double);
    if (s_.host_corrects) {
      work_.host(bytes + 3 * rows * sizeof(double));
    } else {
      work_.pass(bytes);
    }
    if (few_loads()) return;
    work_.pass(rows * real() * static_cast<double>(s_.loaded));
    work_.pass(2 * rows * sizeof(double));
  }

  /// Stress with its summary, and f - K u.
  void state(bool balance) {
    const double elements = static_cast<double>(s_.elements);
    if (s_.norms) {
      // Shape, corners, state, displacement of four nodes; what is kept.
      const double bytes = 96 + 16 + 16 + 128 + (s_.stress ? 8 * real() : 0);
      work_.pass(bytes * elements);
      work_.seconds(elements * rates_.stress);
    }
    balance = balance || !s_.norms;
    if (balance && s_.host_corrects) {
      work_.seconds(elements * rates_.host_element);
    } else if (balance) {
      work_.pass(static_cast<double>(s_.stiffness_bytes));
    }
    work_.pass(0);
  }

  void iterate(double iterations) {
    const double nodes = static_cast<double>(s_.rows) / 3;
    const double bytes = static_cast<double>(s_.stiffness_bytes) + kIterationBytes * nodes;
    work_.passes(iterations * kIterationDispatches, iterations * bytes);
  }

  /// du by the whole inverse or by conjugate gradients, and its stress.
  void check() {
    const double rows = static_cast<double>(s_.rows);
    work_.submit();
    if (s_.cg) {
      iterate(kIterations / 5);  // to two digits of eleven
    } else {
      work_.pass(rows * rows * real());
      work_.pass(2 * rows * sizeof(double));
    }
    work_.pass(256 * static_cast<double>(s_.elements));
    work_.seconds(static_cast<double>(s_.elements) * rates_.stress);
    work_.pass(0);
  }

  const FrameShape& s_;
  Rates rates_;
  Work work_;
};

}  // namespace

FrameCost frame_cost(const FrameShape& shape, const vulkan::PhysicalDevice& device) {
  const Rates of_device = rates(device);
  FrameCost cost;
  Frame quiet(shape, of_device), fracture(shape, of_device);
  const Work& of_quiet = quiet.quiet();
  cost.quiet_ms = of_quiet.milliseconds();
  cost.quiet_bytes = of_quiet.bytes();
  if (!shape.damage) return cost;
  const Work& of_fracture = fracture.with_fracture();
  cost.fracture_ms = of_fracture.milliseconds();
  cost.fracture_bytes = of_fracture.bytes();
  return cost;
}

}  // namespace sunder::gpu
