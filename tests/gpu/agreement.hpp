// SPDX-License-Identifier: Apache-2.0
// What the Vulkan backend may differ from the CPU reference by, way by way: the accuracy table.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "body/pieces.hpp"
#include "gpu_body.hpp"

namespace sunder::test {

/// All ways of route inverse, what a device may do of it beside, and those of route cg.
inline std::vector<Way> ways_of_every_route() {
  std::vector<Way> ways = all_ways();
  ways.push_back({.inverts = true});
  ways.push_back({.damage = true});
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    for (Precision precision : {Precision::fp32, Precision::fp64}) {
      ways.push_back({variant, precision, Update::automatic, 1e-4, 0, Route::cg});
    }
  }
  return ways;
}

/// Route cg solves anew whatever came before, in the time of all else: it is not compared at every
/// count but in the soak.
#ifdef SUNDER_SOAK
inline constexpr bool kSoak = true;
#else
inline constexpr bool kSoak = false;
#endif

/// Elements of pieces that nothing holds any more: they have no displacement to compare.
inline std::vector<std::uint8_t> loose_elements(const Backend& backend) {
  std::vector<std::uint8_t> loose(backend.problem().mesh().tets.size(), 0);
  for (const auto& piece : find_loose_parts(backend.problem(), backend.destroyed()).pieces) {
    for (Index e : piece) loose[static_cast<std::size_t>(e)] = 1;
  }
  return loose;
}

/// A pull of the part that a cut at y = 26.5 leaves attached, so that its field is one worth
/// checking; a little hangs below.
inline std::vector<double> force_above_the_cut(const Mesh& mesh) {
  std::vector<double> force =
      shared_force(mesh, nodes_in(mesh, {Vec3(49.9, 35, -1), Vec3(51, 45, 3)}), Vec3(5, 0, 0));
  const auto below = corner_force(mesh, Vec3(0, -6e-3, 0));
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += below[i];
  return force;
}

class Agreement : public WithVulkan<testing::TestWithParam<Way>> {
 protected:
  [[nodiscard]] bool fp64() const { return GetParam().precision == Precision::fp64; }
  [[nodiscard]] double allowed(double of_fp64) const { return fp64() ? of_fp64 : kFp32Tolerance; }
  /// Solves, and compares all but `ignored` and destroyed elements.
  Pair::Errors expect(Pair& pair, double of_fp64, const std::string& where,
                      std::span<const std::uint8_t> ignored = {}) const {
    const auto e = pair.solve(ignored);
    const double most = allowed(of_fp64);
    EXPECT_TRUE(e.u <= most) << where << ": displacement error " << e.u;
    EXPECT_TRUE(e.stress <= most) << where << ": stress error " << e.stress;
    EXPECT_LE(e.report.error, GetParam().tolerance) << where;
    return e;
  }
  void expect_same_summary(const Pair::Errors& e, double of_fp64) const {
    EXPECT_EQ(e.summary.any.element, e.reference_summary.any.element);
    EXPECT_NEAR(e.summary.any.ratio, e.reference_summary.any.ratio,
                10 * allowed(of_fp64) * e.reference_summary.any.ratio);
    EXPECT_EQ(e.summary.candidate.element, e.reference_summary.candidate.element);
  }

  /// Destroys a sequence one by one, and compares at the accuracy table's counts up to its end.
  void follow(Pair& pair, const std::vector<Index>& sequence, double tolerance) const {
    std::size_t done = 0;
    for (std::size_t count : {1, 10, 50, 100, 200}) {
      if (count > sequence.size()) break;
      if (!kSoak && GetParam().route == Route::cg && count != 10 && count != 200) continue;
      for (; done < count; ++done) pair.destroy({&sequence[done], 1});
      const auto errors = expect(pair, tolerance, std::to_string(count) + " fractures");
      expect_same_summary(errors, tolerance);
      record(count, errors);
    }
  }
  /// The drift curve, in the test's report.
  static void record(std::size_t count, const Pair::Errors& errors) {
    const auto text = [](double value) { return (std::ostringstream() << value).str(); };
    RecordProperty("u_after_" + std::to_string(count), text(errors.u));
    RecordProperty("stress_after_" + std::to_string(count), text(errors.stress));
  }
};

}  // namespace sunder::test
