// SPDX-License-Identifier: Apache-2.0
// Geometry factors F of finite boards (method.md 6). x is clamped to [0, 0.95].
#pragma once

namespace sunder::fracture {

inline constexpr double kLargestRelativeLength = 0.95;

/// Edge crack of length a across a chord b, x = a/b: polynomial up to 0.6, Tada's formula above.
[[nodiscard]] double edge_factor(double x);
/// The two branches of edge_factor.
[[nodiscard]] double edge_factor_polynomial(double x);
[[nodiscard]] double edge_factor_tada(double x);

/// Internal crack of length 2a across a chord b, x = 2a/b: Feddersen's secant with Tada's factor.
[[nodiscard]] double internal_factor(double x);

}  // namespace sunder::fracture
