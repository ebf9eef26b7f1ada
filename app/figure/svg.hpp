// SPDX-License-Identifier: Apache-2.0
// The few SVG elements that pictures and charts are made of, as text.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sunder/types.hpp"

namespace sunder::app::svg {

/// Opening tag of a document of this size, in user units.
[[nodiscard]] std::string open(double width, double height, std::string_view attributes = {});

/// `attributes` are written as they are: `fill="#fff"`.
[[nodiscard]] std::string rect(const Vec2& corner, const Vec2& size, std::string_view attributes);
[[nodiscard]] std::string line(const Vec2& a, const Vec2& b, std::string_view attributes);
[[nodiscard]] std::string circle(const Vec2& center, double radius, std::string_view attributes);
[[nodiscard]] std::string polyline(std::span<const Vec2> points, std::string_view attributes);
[[nodiscard]] std::string polygon(std::span<const Vec2> points, std::string_view attributes);
/// `content` is escaped.
[[nodiscard]] std::string text(const Vec2& at, std::string_view content,
                               std::string_view attributes);

/// A coordinate: two decimals, trailing zeros dropped.
[[nodiscard]] std::string coordinate(double value);

}  // namespace sunder::app::svg
