// SPDX-License-Identifier: Apache-2.0
// A problem on the CPU reference and on Vulkan at once, driven below the frame. Validation and
// synchronization validation watch every Vulkan call, sentinels every buffer.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "gpu/choose_device.hpp"
#include "gpu/vulkan_backend.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/loads.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

/// Fails without a Vulkan device, unless SUNDER_EXPECT_NO_VULKAN says beforehand that there is
/// none.
template <class Base = testing::Test>
class WithVulkan : public Base {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
  }
};

/// What the DeviceError says that f() is to throw.
inline std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "no DeviceError was thrown";
}

/// Everywhere but under a sanitizer.
inline bool validated() { return std::getenv("SUNDER_WITHOUT_VALIDATION") == nullptr; }

/// Sentinels round every buffer, and what SUNDER_VULKAN_PROBE lists: with as_gpu a program's tests
/// run on memory that the host reaches by copies alone.
inline vulkan::DeviceProbe watched_probe() {
  vulkan::DeviceProbe probe = gpu::options_from_environment().probe;
  probe.guard_bytes = 256;
  return probe;
}

/// The device that a scene would get.
inline std::unique_ptr<vulkan::Device> watched_device(
    const std::shared_ptr<const vulkan::Instance>& instance, const vulkan::DeviceProbe& probe) {
  return vulkan::create_device(instance, gpu::choose_device(*instance, kNone, probe), probe);
}

/// One way to run a scene on Vulkan.
struct Way {
  gpu::Variant variant = gpu::Variant::lvp;
  Precision precision = Precision::fp64;
  Update update = Update::deferred;
  double tolerance = 1e-4;
  std::size_t panel_bytes = 0;
  Route route = Route::inverse;
  bool float64 = true;   ///< false: the device has no shaderFloat64
  bool inverts = false;  ///< the device computes the inverse
  bool region = false;   ///< the device multiplies the columns of a condensed region
  bool damage = false;   ///< the device solves with the small matrices of the damage
};

inline std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    ways.push_back({variant, Precision::fp32, Update::deferred});
    ways.push_back({variant, Precision::fp64, Update::deferred});
    ways.push_back({variant, Precision::fp64, Update::eager});
    ways.push_back({.variant = variant, .precision = Precision::fp32, .float64 = false});
  }
  return ways;
}

inline std::string name_of(const Way& s) {
  const char* how = s.route == Route::cg           ? "_cg"
                    : s.update == Update::eager    ? "_eager"
                    : s.update == Update::deferred ? "_deferred"
                                                   : "";
  return std::string(s.variant == gpu::Variant::gpu ? "gpu" : "lvp") +
         (s.precision == Precision::fp64 ? "_fp64" : "_fp32") + how + (s.float64 ? "" : "_single") +
         (s.inverts ? "_inverts" : "") + (s.region ? "_region" : "") + (s.damage ? "_damage" : "");
}

inline std::shared_ptr<const Problem> vulkan_problem(Scene scene, const Way& way) {
  scene.solver.backend = "vulkan";
  scene.solver.precision = way.precision;
  scene.solver.update = way.update;
  scene.solver.tolerance = way.tolerance;
  scene.solver.route = way.route;
  return std::make_shared<Problem>(std::move(scene));
}

/// Makes Vulkan backends under validation with sentinels round every buffer. What these report
/// while a backend lives or when it ends fails the test.
class WatchedBackend {
 public:
  WatchedBackend(Scene scene, const Way& way) : problem(vulkan_problem(std::move(scene), way)) {
    options.instance.validation = validated();
    options.instance.messages = messages_;
    options.probe = watched_probe();
    options.variant = way.variant;
    options.panel_bytes = way.panel_bytes;
    options.probe.no_float64 = !way.float64;
    if (way.inverts) options.invert_on_device = true;
    if (way.region) options.region_on_device = true;
    if (way.damage) options.damage_on_device = true;
  }
  /// Every backend must be gone by then.
  ~WatchedBackend() {
    for (const std::string& m : messages_->texts) ADD_FAILURE() << m;
  }
  WatchedBackend(const WatchedBackend&) = delete;
  WatchedBackend& operator=(const WatchedBackend&) = delete;

  [[nodiscard]] std::unique_ptr<Backend> create() const { return create(needs_of(*problem)); }
  [[nodiscard]] std::unique_ptr<Backend> create(Needs needs) const {
    return gpu::create(problem, std::move(needs), options);
  }

  std::shared_ptr<const Problem> problem;
  gpu::VulkanOptions options;

 private:
  std::shared_ptr<vulkan::Messages> messages_ = std::make_shared<vulkan::Messages>();
};

/// The elements that a scene run to its end destroys, in order.
inline std::vector<Index> destroyed_by(const std::shared_ptr<const Problem>& problem,
                                       std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  while (!simulation.done()) simulation.step();
  std::vector<Index> list;
  for (const DestroyedElement& d : simulation.destroyed()) list.push_back(d.element);
  return list;
}

/// Displacement and stress of two runs of one body agree, as shares of the largest.
inline void expect_alike(const Simulation& found, const Simulation& expected, double share) {
  const auto u = found.displacement(), exact = expected.displacement();
  double most = 0, apart = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    most = std::max(most, exact[n].norm());
    apart = std::max(apart, (u[n] - exact[n]).norm());
  }
  EXPECT_LE(apart, share * most);
  const auto s = found.stress(), right = expected.stress();
  double largest = 0, wrong = 0;
  for (std::size_t e = 0; e < s.size(); ++e) {
    largest = std::max(largest, right[e].norm());
    wrong = std::max(wrong, (s[e] - right[e]).norm());
  }
  EXPECT_LE(wrong, share * largest);
}

class Pair {
 public:
  /// `adjust` may set more of what the Vulkan backend is created with.
  Pair(Scene scene, const Way& way, const Needs& needs = all_needs(),
       const std::function<void(gpu::VulkanOptions&)>& adjust = {})
      : problem_(cpu_problem(scene)),
        watched_(std::move(scene), way),
        solutions_(way.damage ? 3 : 1) {
    if (adjust) adjust(watched_.options);
    reference = cpu_reference::create(problem_, needs);
    vulkan = watched_.create(needs);
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  [[nodiscard]] const Problem& problem() const { return *problem_; }

  void load(const Load& load) {
    reference->set_load(load);
    vulkan->set_load(load);
  }
  void destroy(std::span<const Index> elements) {
    reference->destroy(elements);
    vulkan->destroy(elements);
  }

  struct Errors {
    double u = 0, stress = 0;
    SolveReport report;
    StressSummary summary, reference_summary;
  };
  /// Solves on both. Elements in `ignored` (besides destroyed ones) do not count.
  Errors solve(std::span<const std::uint8_t> ignored = {}) {
    Errors errors;
    reference->solve();
    for (int i = 0; i < solutions_; ++i) errors.report = vulkan->solve();
    errors.reference_summary = reference->stress();
    errors.summary = vulkan->stress();
    std::vector<std::uint8_t> out(vulkan->destroyed().begin(), vulkan->destroyed().end());
    for (std::size_t e = 0; e < ignored.size(); ++e) out[e] |= ignored[e];
    errors.u =
        displacement_error(problem().mesh(), out, displacement(*vulkan), displacement(*reference));
    errors.stress = stress_error(out, stress(*vulkan), stress(*reference));
    return errors;
  }

  /// Forces of the grips, against the reference's largest.
  void expect_reactions(double tolerance) {
    std::vector<double> r(problem().gripped_dofs().size()), expected(r.size());
    ASSERT_FALSE(r.empty());
    vulkan->read_reactions(r);
    reference->read_reactions(expected);
    double largest = 0;
    for (double v : expected) largest = std::max(largest, std::abs(v));
    for (std::size_t i = 0; i < r.size(); ++i) {
      EXPECT_NEAR(r[i], expected[i], tolerance * largest) << "grip " << i;
    }
  }

  [[nodiscard]] static std::vector<double> displacement(const Backend& backend) {
    std::vector<double> u(3 * backend.problem().mesh().nodes.size());
    backend.read_displacement(u);
    return u;
  }
  [[nodiscard]] static std::vector<Voigt> stress(const Backend& backend) {
    std::vector<Voigt> s(backend.problem().mesh().tets.size());
    backend.read_stress(s);
    return s;
  }

 private:
  static std::shared_ptr<const Problem> cpu_problem(Scene scene) {
    scene.solver = {};
    scene.solver.backend = "cpu";
    return std::make_shared<Problem>(std::move(scene));
  }
  std::shared_ptr<const Problem> problem_;
  WatchedBackend watched_;
  int solutions_;  // until a device has the small matrices of damage

 public:
  std::unique_ptr<Backend> reference, vulkan;  // gone before what watches them
};

}  // namespace sunder::test
